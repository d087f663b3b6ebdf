// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet extract`: the input's surface, out of a tet file.
#include <algorithm>
#include <iostream>
#include <memory>

#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/same_file.hpp"
#include "common/terminal_progress.hpp"
#include "common/tet_file.hpp"
#include "surface/write_surface.hpp"
#include "tet/command.hpp"

namespace tetprep {
namespace {

struct ExtractOptions {
  std::string file, surface;
  bool pieces = false, ascii = false;
};

/// Triangles are found by indices that the file holds, so those are proved first.
tetfmt::TrustedView proved(const TetFile& file) {
  auto trusted = tetfmt::TrustedView::validated(file.view().bytes(), tetfmt::Level::topology);
  if (!trusted) {
    throw Failure(is_unsupported(trusted.error().code) ? ExitCode::unsupported : ExitCode::invalid,
                  file.path() + ": " + tetfmt::to_string(trusted.error()) +
                      "; `tet validate` tells more, convert the input again");
  }
  return std::move(trusted).value();
}

void print_summary(const ExtractOptions& options, const SurfaceMesh& mesh) {
  const auto counted = [](std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
  };
  std::string line =
      options.surface + ": " + counted(mesh.triangles.size(), options.pieces ? "piece" : "triangle");
  line += " of " + counted(mesh.input_triangle_count, "input triangle");
  if (mesh.left_out > 0) {
    line += "; " + counted(mesh.left_out, "triangle") + (mesh.left_out == 1 ? " is" : " are") +
            " not in the file (degenerate, a repetition of another one, or in space that was left out)";
  }
  std::cerr << "tet extract: " << one_line(line) << '\n';
}

int run_extract(const ExtractOptions& options) {
  refuse_same_file(options.file, options.surface);
  const std::string materials = material_path(options.surface);
  if (!materials.empty()) refuse_same_file(options.file, materials);
  // The name before the file, which may take long to prove.
  const auto writer = make_surface_writer(options.surface, {options.ascii, options.pieces});
  const TetFile file(options.file);
  SurfaceMesh mesh;
  std::vector<std::string> losses;
  {
    TerminalProgress progress;
    progress.stage("validate");
    const tetfmt::TrustedView trusted = proved(file);
    progress.stage("read");
    try {
      mesh = read_surface(trusted, options.pieces);
    } catch (const Failure& failure) {
      throw Failure(failure.code(), options.file + ": " + failure.what());
    }
    if (mesh.triangles.empty())
      throw Failure(ExitCode::unsupported, options.file + ": there is no surface in this file");
    progress.stage("write");
    losses = writer->write(mesh);
  }
  print_summary(options, mesh);
  for (const std::string& loss : losses) std::cerr << "tet extract: warning: " << one_line(loss) << '\n';
  const auto& material = mesh.appearance.triangle_material;
  const auto unknown = std::count_if(mesh.input_triangle.begin(), mesh.input_triangle.end(),
                                     [&](Index t) { return !material.empty() && material[t] == kNone; });
  if (unknown > 0)
    std::cerr << "tet extract: warning: the material of " << unknown
              << " triangles is not in the file: other triangles lie on top of them\n";
  return 0;
}

}  // namespace

void add_extract_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<ExtractOptions>();
  CLI::App* verb = app.add_subcommand(
      "extract", "Give the surface back that went into a tet file: triangles, materials, attributes.");
  verb->add_option("FILE", options->file, "A tet file")->required();
  verb->add_option("--surface", options->surface,
                   "The mesh to write; its format by the name's ending: .ply or .obj")
      ->required()
      ->type_name("MESH");
  verb->add_flag(
      "--pieces", options->pieces,
      "The triangles as they were cut up where the input met itself, instead of whole; .ply only. "
      "Each\n"
      "face's input_triangle is the one that it is a piece of. Without normals and other values at "
      "vertices");
  verb->add_flag("--ascii", options->ascii, "PLY as text instead of binary little-endian");
  verb->footer(
      "Triangles are in the input's order, in the input's coordinates: those that the file holds, which is "
      "the "
      "input\n"
      "moved to the file's grid. Triangles that the converter left out (degenerate, repeated, in left-out "
      "space) are counted on "
      "standard\n"
      "error. Text shows numbers by the fewest digits that read back as the same number.\n"
      "\n"
      "PLY: double x y z; as far as the file has them float nx ny nz, float s t, uchar red green blue alpha "
      "(float if a\n"
      "  colour is no multiple of 1/255; no alpha if it is 1 everywhere) and the input's own properties in "
      "their "
      "types;\n"
      "  nan stands for what a vertex does not have. Places with several values are several vertices. Faces "
      "have "
      "int\n"
      "  material and int object (from 0; -1: not known), whose names are comments in the header.\n"
      "OBJ: v (with colours), vt, vn, o or g for objects, usemtl; materials go into a file beside it, named "
      "alike but\n"
      "  ending in .mtl, which is replaced. Properties and opacity of colours have no place in OBJ.\n"
      "\n"
      "Exit codes: 0 done; 1 usage; 2 a file cannot be read or written; 3 a broken tet file; 5 a kind of "
      "file "
      "that\n"
      "this version or build does not know, or one without a surface. On failure nothing is left at MESH.\n"
      "\n"
      "Examples:\n"
      "  tet extract bunny.tet --surface bunny.ply\n"
      "  tet extract scene.tet --surface scene.obj\n"
      "  tet extract scene.tet --surface pieces.ply --pieces --ascii");
  verb->callback([options, &run] { run = [options] { return run_extract(*options); }; });
}

}  // namespace tetprep
