// The window's words.
#include <map>

#include "app/view_panels.h"

namespace app {

Words words_for(const std::string& name) {
  static const std::map<std::string, Words> words = {
      {"from_aorta", {"From the aorta", "The surgeon's view: down the aorta onto the open or closed valve."}},
      {"from_ventricle", {"From the ventricle", "Up from the left ventricle onto the underside of the leaflets."}},
      {"long_axis", {"Long axis", "Cut along the aorta, as in a long-axis echocardiogram; the aorta is at the top."}},
      {"short_axis", {"Short axis", "Cut across at the height of the leaflets, as in a short-axis echocardiogram."}},
      {"pair", {"Blood and valve", "Two pictures along the long axis: the blood's pressure, and the stress on the valve."}},
      {"oblique", {"Oblique", "From the side and a little from above."}},
      {"front", {"Front", "From the front."}},
      {"side", {"Side", "From the side."}},
      {"top", {"Top", "From above."}},
      {"plane", {"Plane", "The two-dimensional scene."}},
      {"stress",
       {"Stress on the tissue",
        "How hard the tissue is strained at each place (von Mises). High stress lasting for years goes with wear."}},
      {"principal_stress", {"Largest tension", "The largest tension in any direction at each place (first principal stress)."}},
      {"displacement", {"Displacement", "How far each place has moved from where it was at the start."}},
      {"pressure", {"Blood pressure", "The pressure of the blood at each place."}},
      {"speed", {"Blood speed", "How fast the blood flows at each place; the jet through the valve is the fastest."}},
  };
  const auto found = words.find(name);
  return found == words.end() ? Words{name, ""} : found->second;
}

}  // namespace app
