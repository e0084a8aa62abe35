#pragma once
// The frames of a scene's events by shots.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "src/cli/frame_files.h"
#include "src/dynamic/edit_session.h"

namespace exitance {

struct ShotFrameOptions : FrameOptions {
  SessionOptions session;
  std::string method;                         ///< its name
  std::optional<std::uint64_t> budget_shots;  ///< most of a frame after the first
  std::vector<std::uint64_t> replayed;        ///< by frame; those behind have none. Empty: nothing is replayed
  std::filesystem::path kept_references;      ///< where their solutions are kept for other runs; empty: nowhere
  std::uint64_t memory = 0;                   ///< for the form factors of references [bytes]
  std::filesystem::path checkpoint;           ///< where what was shot is kept until all frames are done
  std::string key;           ///< what it depends on, as a Checkpoint's; with another one all begins anew
  double save_seconds = 30;  ///< how often
};

struct ShotFrames {
  FrameList list;         ///< also of frames that an earlier run has done, and of the one in hand where it was stopped
  bool finished = false;  ///< all are done; if not, the same options go on from there
};

/// Follows the scene through its events; frame 0 is the scene before the first. Warns of objects that pass through
/// others or have left the scene. Writes frame_*.png and frame_*.vtp into the folder. Errors are eq. 7 of George et al.
/// (1990) against the converged solution of each frame.
ShotFrames follow_shots(const DynamicScene& given, const ShotFrameOptions& options,
                        const std::filesystem::path& folder);

}  // namespace exitance
