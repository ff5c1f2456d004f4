// What several runs beside one another are called: their titles where these differ, else the settings in which they differ.
#pragma once

#include <string>
#include <vector>

namespace app {

struct RunNames {
  std::vector<std::string> names;  // one a run, all different
  std::string shared;              // settings that all have, for one line over all of them
};
// One entry a run: titles; settings_text (parts between dots, items between commas); the scene keys set by hand, "key=value", by the last
// part of which runs are told apart where the first two do not. Runs that nothing tells apart are numbered.
RunNames run_names(const std::vector<std::string>& titles, const std::vector<std::string>& settings,
                   const std::vector<std::vector<std::string>>& keys);

}  // namespace app
