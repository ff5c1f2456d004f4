// RUN.xmf: the frames of a run file as ParaView and VisIt open them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sim {

// Grows by one `Time` grid a frame; valid XML after every call, even if the program is killed between them.
class XdmfFile {
 public:
  XdmfFile(const std::filesystem::path& file, const std::string& run_file_name);  // starts it anew
  void add_frame(const std::string& group, double time, std::size_t particles);

 private:
  std::filesystem::path file_;
  std::string run_file_name_;
  std::int64_t tail_at_ = 0;  // bytes before the closing tags
};

}  // namespace sim
