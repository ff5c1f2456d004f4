#include "app/measure_render.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <stdexcept>

namespace app {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Seconds that all processors together have worked for this program.
double processor_seconds() {
  timespec spent{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

}  // namespace

render::PictureSettings draft_settings(int width, int height) {
  render::PictureSettings settings{std::max(160, width / 2), std::max(120, height / 2), {}};
  settings.draw.ambient_occlusion = settings.draw.smooth_edges = false;
  return settings;
}

RenderSpeed measure_render(const MovieJob& job, int pictures) {
  const sim::RunReader run(job.runs.front());
  if (run.frame_count() == 0) throw std::invalid_argument(job.runs.front().string() + ": holds no finished frame yet");
  const FrameMaker maker(run, job.choice, field_ranges({&run}));
  render::Renderer renderer;
  const render::PictureSettings full{job.width, job.height, {}}, draft = draft_settings(job.width, job.height);
  renderer.draw(maker.make(0), full);  // shaders and buffers are made at the first picture
  RenderSpeed speed;
  speed.driver = renderer.driver();
  for (int k = 0; k < pictures; ++k) {
    const std::size_t index =
        pictures > 1 ? static_cast<std::size_t>(k) * (run.frame_count() - 1) / static_cast<std::size_t>(pictures - 1) : 0;
    double began = now();
    const render::Frame frame = maker.make(index);
    speed.read += now() - began;
    began = now();
    double worked = processor_seconds();
    renderer.draw(frame, full);
    speed.full += now() - began;
    speed.full_processor += processor_seconds() - worked;
    began = now();
    worked = processor_seconds();
    renderer.draw(frame, draft);
    speed.draft += now() - began;
    speed.draft_processor += processor_seconds() - worked;
    speed.particles = std::max(speed.particles, run.frame(index).size());
    speed.panels = frame.panels.size();
    ++speed.pictures;
  }
  for (double* mean : {&speed.read, &speed.full, &speed.draft, &speed.full_processor, &speed.draft_processor})
    *mean /= static_cast<double>(pictures);
  return speed;
}

nlohmann::json render_speed_json(const RenderSpeed& speed) {
  return {{"pictures", speed.pictures},
          {"particles", speed.particles},
          {"panels", speed.panels},
          {"read_seconds", speed.read},
          {"draw_seconds", speed.full},
          {"pictures_per_second", 1 / std::max(speed.full, 1e-9)},
          {"draft_seconds", speed.draft},
          {"drafts_per_second", 1 / std::max(speed.draft, 1e-9)},
          {"draw_processor_seconds", speed.full_processor},
          {"draft_processor_seconds", speed.draft_processor},
          {"driver", speed.driver}};
}

}  // namespace app
