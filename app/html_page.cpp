#include "app/html_page.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "app/assets.h"

namespace app {
namespace {

void replace(std::string& text, const std::string& mark, const std::string& with) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) throw std::runtime_error("report/page.html has no place for " + mark);
  text.replace(at, mark.size(), with);
}

}  // namespace

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": can't be read");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string html_page(const std::string& title, const std::vector<std::string>& scripts, const nlohmann::json& data) {
  std::string page = text_of(asset("report/page.html")), script, text = data.dump();
  for (const std::string& name : scripts) script += text_of(asset("report/" + name));
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos;) text.replace(at, 2, "<\\/");  // no end of the script within
  replace(page, "<title></title>", "<title>" + title + "</title>");
  replace(page, "/*STYLE*/", text_of(asset("report/style.css")));
  replace(page, "/*SCRIPT*/", script);
  replace(page, "{\"DATA\":0}", text);
  return page;
}

}  // namespace app
