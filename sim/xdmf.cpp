#include "sim/xdmf.h"

#include <fcntl.h>
#include <unistd.h>

#include <sstream>
#include <stdexcept>

namespace sim {
namespace {

const char* const tail = "    </Grid>\n  </Domain>\n</Xdmf>\n";

void write_at(const std::filesystem::path& file, const std::string& text, std::int64_t at, int extra_flags) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | extra_flags, 0666);
  const bool good = descriptor >= 0 && pwrite(descriptor, text.data(), text.size(), at) == static_cast<ssize_t>(text.size());
  if (descriptor >= 0) close(descriptor);
  if (!good) throw std::runtime_error(file.string() + ": can't be written; is the folder there, the disk full?");
}

std::string attribute(const std::string& name, const char* type, const char* number, int precision, std::size_t rows, int columns,
                      const std::string& source) {
  std::ostringstream out;
  out << "        <Attribute Name=\"" << name << "\" AttributeType=\"" << type
      << "\" Center=\"Node\"><DataItem Format=\"HDF\" NumberType=\"" << number << "\" Precision=\"" << precision << "\" Dimensions=\""
      << rows;
  if (columns > 1) out << " " << columns;
  out << "\">" << source << "</DataItem></Attribute>\n";
  return out.str();
}

}  // namespace

XdmfFile::XdmfFile(const std::filesystem::path& file, const std::string& run_file_name) : file_(file), run_file_name_(run_file_name) {
  const std::string head =
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"run\" GridType=\"Collection\" "
      "CollectionType=\"Temporal\">\n";
  write_at(file_, head + tail, 0, O_TRUNC);
  tail_at_ = static_cast<std::int64_t>(head.size());
}

void XdmfFile::add_frame(const std::string& group, double time, std::size_t particles) {
  const auto source = [&](const char* name) { return run_file_name_ + ":/frames/" + group + "/" + name; };
  std::ostringstream out;
  out.precision(12);
  out << "      <Grid Name=\"particles\" GridType=\"Uniform\">\n        <Time Value=\"" << time << "\"/>\n"
      << "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" << particles << "\"/>\n"
      << "        <Geometry GeometryType=\"XYZ\"><DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"" << particles
      << " 3\">" << source("position") << "</DataItem></Geometry>\n"
      << attribute("velocity", "Vector", "Float", 4, particles, 3, source("velocity"))
      << attribute("pressure", "Scalar", "Float", 4, particles, 1, source("pressure"))
      << attribute("von_mises_stress", "Scalar", "Float", 4, particles, 1, source("von_mises"))
      << attribute("largest_principal_stress", "Scalar", "Float", 4, particles, 1, source("principal_stress"))
      << attribute("stress", "Tensor6", "Float", 4, particles, 6, source("stress"))
      << attribute("kind", "Scalar", "UChar", 1, particles, 1, source("kind"))
      << attribute("body", "Scalar", "Int", 4, particles, 1, source("body"))
      << attribute("id", "Scalar", "Int", 8, particles, 1, source("id")) << "      </Grid>\n";
  write_at(file_, out.str() + tail, tail_at_, 0);
  tail_at_ += static_cast<std::int64_t>(out.str().size());
}

}  // namespace sim
