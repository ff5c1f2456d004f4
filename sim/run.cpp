#include "sim/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "sim/elastic_stress.h"
#include "sim/ledger.h"
#include "sim/overload.h"
#include "sim/run_columns.h"
#include "sim/static_solution.h"
#include "sim/stress.h"
#include "sim/work_memory.h"

namespace sim {
namespace {

double now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

template <int D>
RunHeader complete_header(const Scene<D>& scene, RunHeader header) {
  const SceneDescription<D>& description = scene.description;
  header.title = description.title, header.dimension = D, header.spacing = description.spacing;
  header.end = description.time.end, header.output = description.time.output;
  header.statics = description.time.mode == TimeMode::static_equilibrium;
  header.scheme = description.scheme.name == Scheme::paper ? "paper" : "accurate";
  header.valve = description.valve;
  for (const Body& body : description.bodies) header.bodies.push_back(body_info(body));
  for (const Port<D>& port : description.ports) header.ports.push_back(port.name);
  for (const ShellMesh<D>& mesh : description.shell_meshes) {
    RunHeader::ShellInfo shell{mesh.body, {}};
    for (const auto& element : mesh.elements) {
      std::array<std::int32_t, 3> corners{-1, -1, -1};
      std::copy(element.begin(), element.end(), corners.begin());
      shell.elements.push_back(corners);
    }
    header.shells.push_back(std::move(shell));
  }
  header.columns = {"time"}, header.units = {header.statics ? "1" : "s"};
  for (const auto& columns : {probe_columns(scene), metric_columns(scene)})
    for (const Column& column : columns) header.columns.push_back(column.name), header.units.push_back(column.units);
  for (const Probe<D>& probe : description.probes) {
    if (!probe.line) continue;
    RunHeader::LineInfo line{probe.name, quantity_units(probe.quantity, D), {}, {}};
    for (const Vector<D>& point : probe.points) line.points.push_back({point[0], point[1], D == 3 ? point[D - 1] : 0});
    for (const std::string& ending : probe_components<D>(probe.quantity)) line.components.push_back("value" + ending);
    header.lines.push_back(std::move(line));
  }
  return header;
}

std::vector<std::vector<double>> mixed(const std::vector<std::vector<double>>& before, const std::vector<std::vector<double>>& after,
                                       double share) {
  std::vector<std::vector<double>> result = after;
  for (std::size_t k = 0; k < result.size(); ++k)
    for (std::size_t i = 0; i < result[k].size(); ++i) result[k][i] = before[k][i] + share * (after[k][i] - before[k][i]);
  return result;
}

// What one run carries from step to step.
template <int D>
struct Running {
  const Scene<D>& scene;
  const RunSetup& setup;
  State<D> state;
  Workspace<D> work, scratch;
  Probes<D> probes;
  std::optional<RunWriter> writer;
  Checkpoint book;  // frames, rows, next output, wall seconds of earlier parts
  double started = now_seconds(), checkpointed = started;
  std::string status_before{};  // of the run that is continued
  RunResult result{};
  std::optional<Overload> worst_overload{};  // of this part, at output times

  Running(const Scene<D>& of_scene, const RunSetup& with_setup) : scene(of_scene), setup(with_setup) {}

  double wall() const { return book.wall_seconds + now_seconds() - started; }

  void write_row(double time, const std::vector<std::vector<double>>& values) {
    std::vector<double> row{time};
    std::vector<std::vector<double>> lines;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (scene.description.probes[k].line)
        lines.push_back(values[k]);
      else
        row.insert(row.end(), values[k].begin(), values[k].end());
    }
    const std::vector<double> metrics = metric_values(scene, state, scratch);
    row.insert(row.end(), metrics.begin(), metrics.end());
    writer->add_row(row, lines);
    result.last_row = std::move(row);
    ++book.rows;
  }

  void write_frame() {
    writer->add_frame(make_run_frame(scene, state));
    ++book.frames;
  }

  void checkpoint(const std::string& status) {
    Checkpoint saved = book;
    saved.wall_seconds = wall();
    saved.memory = work_memory(work);
    writer->set_checkpoint(state, saved);
    writer->set_status(status, saved.wall_seconds, state.step);
    writer->finish();
    checkpointed = now_seconds();
  }

  // k-th output time, without the drift of repeated addition.
  double output_time(std::int64_t k) const {
    return std::min(static_cast<double>(k) * scene.description.time.output, scene.description.time.end);
  }

  // Rows and the frame of all output times that the last step reached. `before`: probes at `from`, empty where they were not evaluated.
  void write_outputs(double from, const std::vector<std::vector<double>>& before) {
    const double slack = 1e-9 * scene.description.time.output;
    if (state.time < book.next_output - slack) return;
    const std::vector<std::vector<double>> after = probes.evaluate(scene, state);
    measure_ledger(scene, state, scratch);
    if (const auto now = overload(scene, state); now && (!worst_overload || now->strain > worst_overload->strain)) worst_overload = now;
    while (state.time >= book.next_output - slack && book.rows <= last_output()) {
      const double time = book.next_output;
      const double share = state.time > from && time < state.time - slack ? std::clamp((time - from) / (state.time - from), 0.0, 1.0) : 1;
      write_row(time, before.empty() ? after : mixed(before, after, share));
      book.next_output = output_time(book.rows);
      if (time >= scene.description.time.end - slack) break;
    }
    write_frame();
    if (now_seconds() - checkpointed >= setup.checkpoint_seconds)
      checkpoint("running");
    else
      writer->finish();
  }
  std::int64_t last_output() const {
    return static_cast<std::int64_t>(std::ceil(scene.description.time.end / scene.description.time.output - 1e-9));
  }

  void start() {
    const State<D> initial = initial_state(scene);
    probes = Probes<D>(scene, initial);
    if (setup.resume) {
      {
        const RunReader reader(setup.file);
        std::tie(state, book) = reader.template checkpoint<D>();
        status_before = reader.status();
        if (reader.header().columns != complete_header(scene, setup.header).columns)
          throw std::runtime_error(setup.file.string() + ": was written for another scene; run it again without --continue");
      }
      restore_work(scene, book.memory, work);
      book.next_output = output_time(book.rows);  // the end may have been moved
      writer = RunWriter::resume(setup.file, book);
      return;
    }
    state = initial;
    writer = RunWriter::create(setup.file, complete_header(scene, setup.header));
    for (const std::string& warning : setup.warnings) writer->add_warning(warning);
    measure_ledger(scene, state, scratch);
    write_row(0, probes.evaluate(scene, state));
    book.next_output = output_time(1);
    write_frame();
    checkpoint("running");
  }

  bool finished() const { return state.time >= scene.description.time.end * (1 - 1e-12); }

  void report() {
    if (!setup.progress) return;
    RunProgress progress;
    progress.time = state.time, progress.end = scene.description.time.end, progress.step = state.step, progress.frames = book.frames;
    progress.wall_seconds = wall(), progress.step_size = state.last_step, progress.particles = static_cast<std::int64_t>(state.size());
    const double done = state.time / scene.description.time.end;
    progress.seconds_left = done > 0 ? progress.wall_seconds * (1 - done) / done : 0;
    setup.progress(progress);
  }

  void end(RunEnding ending, const std::string& status, const std::string& message) {
    result.ending = ending, result.message = message;
    checkpoint(status);
  }

  bool interrupted() {
    if (setup.stop && setup.stop->load()) {
      end(RunEnding::stopped, "stopped: interrupted", "interrupted; `--continue` goes on from here");
      return true;
    }
    const double allowed = scene.description.limits.wall_time;
    if (allowed > 0 && now_seconds() - started >= allowed) {
      end(RunEnding::out_of_time, "stopped: limits.wall_time", "limits.wall_time reached; `--continue` goes on from here");
      return true;
    }
    return false;
  }

  void loop() {
    const TimeSettings& time = scene.description.time;
    std::optional<StaticSolution<D>> statics;
    if (time.mode == TimeMode::static_equilibrium) statics.emplace(scene);
    while (!finished()) {
      if (interrupted()) return;
      const double from = state.time;
      std::vector<std::vector<double>> before;
      try {
        if (statics) {
          statics->advance(state, book.next_output);
        } else {
          if (!scene.description.probes.empty() &&
              (state.last_step == 0 || from + 2 * std::max(state.last_step, time.step) >= book.next_output))
            before = probes.evaluate(scene, state);
          step(scene, state, work, time.end - from);
        }
      } catch (const std::runtime_error& failure) {  // NumericalFailure, NoEquilibrium: the state is the last good one
        writer->add_warning(failure.what());
        if (state.step > 0) write_frame();
        end(RunEnding::failed, std::string("failed: ") + failure.what(), failure.what());
        return;
      } catch (const std::bad_alloc&) {
        work = Workspace<D>(), scratch = Workspace<D>();  // room to say so; the last checkpoint stays, the present state may be half a step
        const std::string message = "not enough memory at t = " + std::to_string(state.time) +
                                    " s; make the spacing larger, or raise limits.memory or the system's limit; `--continue` goes on";
        writer->set_status("failed: " + message, wall(), state.step);
        writer->finish();
        result.ending = RunEnding::failed, result.message = message;
        return;
      }
      result.particle_steps += static_cast<double>(state.size());
      write_outputs(from, before);
      report();
    }
    close();
  }

  // The books are closed. A run that was killed after its last step, before this, is closed when it is continued.
  void close() {
    result.over_limits = over_limits(scene, state);
    if (worst_overload) result.notices.push_back(overload_message(scene, *worst_overload));
    for (const std::string& line : result.over_limits) writer->add_warning(line);
    for (const std::string& line : result.notices) writer->add_warning(line);
    end(RunEnding::finished, "finished", "");
  }
};

}  // namespace

template <int D>
RunFrame make_run_frame(const Scene<D>& scene, const State<D>& state) {
  RunFrame frame;
  const std::size_t rows = state.size();
  frame.time = state.time, frame.step = state.step;
  frame.id = state.id, frame.body = state.body;
  frame.kind.resize(rows), frame.position.resize(rows), frame.velocity.resize(rows), frame.pressure.resize(rows);
  frame.stress.resize(rows), frame.von_mises.resize(rows), frame.principal_stress.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    frame.kind[i] = static_cast<std::uint8_t>(state.kind[i]);
    for (int axis = 0; axis < D; ++axis) {
      frame.position[i][axis] = state.position[i][axis];
      frame.velocity[i][axis] = static_cast<float>(state.velocity[i][axis]);
    }
    frame.pressure[i] = static_cast<float>(state.pressure[i]);
  }
  const std::vector<Eigen::Matrix3d> stress = elastic_stress(scene, state);
  for (std::size_t i = 0; i < stress.size(); ++i) {
    const Eigen::Matrix3f s = stress[i].cast<float>();
    frame.stress[i] = {s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
    frame.von_mises[i] = static_cast<float>(von_mises(stress[i]));
    frame.principal_stress[i] = static_cast<float>(principal_stresses(stress[i])[0]);
    if (state.kind[i] == Kind::elastic) frame.pressure[i] = static_cast<float>(-stress[i].trace() / 3);
  }
  return frame;
}

template <int D>
RunResult run(const Scene<D>& scene, const RunSetup& setup) {
  Running<D> running(scene, setup);
  running.work.stage_times.trace.reserve(setup.trace_events);
  running.start();
  running.result.columns = complete_header(scene, setup.header).columns;
  if (!running.finished())
    running.loop();
  else if (running.status_before == "finished")
    running.result.ending = RunEnding::already_finished;
  else
    running.close();
  running.result.time = running.state.time;
  running.result.steps = running.state.step;
  running.result.frames = running.book.frames;
  running.result.wall_seconds = running.wall();
  running.result.stage_times = std::move(running.work.stage_times);
  return std::move(running.result);
}

template RunResult run(const Scene<2>&, const RunSetup&);
template RunResult run(const Scene<3>&, const RunSetup&);
template RunFrame make_run_frame(const Scene<2>&, const State<2>&);
template RunFrame make_run_frame(const Scene<3>&, const State<3>&);

}  // namespace sim
