// The report page: what is in it, what is not, and what a browser makes of it.
#include "app/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <regex>

#include "app/base64.h"
#include "app/commands.h"
#include "app/glb.h"
#include "tests/app/example_run.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class Report : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("cusp_report_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    app::example::write_valve_run(folder_ / "run.h5", 21);
  }
  void TearDown() override { fs::remove_all(folder_); }
  app::ReportOptions options(std::vector<fs::path> runs) const {
    app::ReportOptions chosen;
    chosen.runs = std::move(runs), chosen.output = folder_ / "report.html", chosen.with_pictures = false;
    return chosen;
  }
  fs::path folder_;
};

TEST(Base64, KnownAnswers) {  // RFC 4648, section 10
  const auto of = [](const std::string& text) { return app::base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(Glb, ChunksAndAccessorsAddUp) {
  app::GlbSurface surface;
  surface.name = "leaflet", surface.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, surface.triangles = {{0, 1, 2}}, surface.value = {0, 5, 10};
  const std::vector<unsigned char> bytes = app::glb_bytes({surface}, {{"open", {0}}}, 10);
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint32_t>(bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | bytes[at + 3] << 24);
  };
  EXPECT_EQ(word(0), 0x46546C67u);
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), bytes.size());
  const std::size_t length = word(12);
  EXPECT_EQ(length % 4, 0u);
  EXPECT_EQ(word(16), 0x4E4F534Au);
  const json gltf = json::parse(std::string(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(length)));
  EXPECT_EQ(word(20 + length) + 28 + length, bytes.size());
  EXPECT_EQ(word(24 + length), 0x004E4942u);
  EXPECT_EQ(gltf["buffers"][0]["byteLength"], word(20 + length));
  EXPECT_EQ(gltf["accessors"].size(), 4u);  // position, colour, value, index
  for (const json& view : gltf["bufferViews"])
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), word(20 + length));
}

TEST_F(Report, HoldsItAllAndLeadsNowhere) {
  std::ofstream(folder_ / "movie.mp4") << "not really";
  EXPECT_GT(app::write_report(options({folder_ / "run.h5"})), 20000u);
  const std::string page = text_of(folder_ / "report.html");
  for (const char* part : {"for planning research, not for clinical decisions", "Content-Security-Policy", "data:video/mp4;base64,",
                           "Geometric orifice area", "m_mode.first", "\"glb\"", "stress above the law"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  // No address outside, but for the name of the SVG language.
  std::string without = std::regex_replace(page, std::regex("http://www\\.w3\\.org/2000/svg"), "");
  EXPECT_EQ(without.find("http://"), std::string::npos);
  EXPECT_EQ(without.find("https://"), std::string::npos);
  EXPECT_EQ(page.find(folder_.string()), std::string::npos) << "the page names a folder of this machine";
}

TEST_F(Report, FileNamesAreLeftOut) {
  EXPECT_EQ(app::without_file_names("aorta = { file = \"Doe_John 1950.stl\", units = \"mm\" }"),
            "aorta = { file = \"(file)\", units = \"mm\" }");
  EXPECT_EQ(app::without_file_names("law = \"neo-hookean\""), "law = \"neo-hookean\"");
}

TEST_F(Report, TwoRunsMakeAComparison) {
  app::example::write_valve_run(folder_ / "stiff.h5", 21, 6e5, "Stiffer valve");
  app::ReportOptions chosen = options({folder_ / "run.h5", folder_ / "stiff.h5"});
  chosen.with_movie = false;
  app::write_report(chosen);
  const std::string page = text_of(folder_ / "report.html");
  EXPECT_NE(page.find("Stiffer valve"), std::string::npos);
  EXPECT_NE(page.find("Example valve"), std::string::npos);
}

TEST_F(Report, AFlatRunHasAPageToo) {
  app::example::write_flat_run(folder_ / "flat.h5");
  EXPECT_GT(app::write_report(options({folder_ / "flat.h5"})), 5000u);
}

TEST_F(Report, BadInputExitsWith2) {
  std::ofstream(folder_ / "no.h5") << "nothing";
  const auto cusp = [](std::vector<std::string> words) {
    words.insert(words.begin(), "cusp");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    return app::run_program(static_cast<int>(arguments.size()), arguments.data());
  };
  EXPECT_EQ(cusp({"report", (folder_ / "none.h5").string()}), 2);
  EXPECT_EQ(cusp({"report", (folder_ / "no.h5").string(), "-o", (folder_ / "x.html").string()}), 2);
  EXPECT_EQ(cusp({"report", (folder_ / "run.h5").string(), "--movie", "missing.mp4", "--no-pictures", "-o", (folder_ / "x.html").string()}),
            2);
}

// A headless Chromium opens the page, which tests itself: model drawn and turned, no console message, nothing asked of a network.
TEST_F(Report, ChromiumDrawsAndTurnsIt) {
  if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "chromium is not installed";
  app::write_report(options({folder_ / "run.h5"}));
  const std::string command =
      "timeout 400 chromium --headless --no-sandbox --disable-gpu-sandbox --use-gl=angle --use-angle=swiftshader "
      "--enable-unsafe-swiftshader --host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr --v=0 --user-data-dir='" +
      (folder_ / "profile").string() + "' --virtual-time-budget=20000 --dump-dom 'file://" + (folder_ / "report.html").string() +
      "#check' > '" + (folder_ / "dom.html").string() + "' 2> '" + (folder_ / "log.txt").string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << text_of(folder_ / "log.txt");
  const std::string dom = text_of(folder_ / "dom.html"), log = text_of(folder_ / "log.txt");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(dom, found, std::regex("<pre id=\"check\">([^<]*)</pre>"))) << log;
  const json check = json::parse(found[1].str());
  EXPECT_EQ(check["viewers"], 1);
  EXPECT_TRUE(check["turned"]) << check;
  EXPECT_GT(check["drawn"][0], 5000);
  EXPECT_GE(check["charts"], 6);
  EXPECT_EQ(log.find("CONSOLE"), std::string::npos) << log;
}

}  // namespace
