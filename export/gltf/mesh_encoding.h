#pragma once

namespace parkade {

/// How triangles stand in a glTF file: as they are, or compressed (KHR_draco_mesh_compression).
enum class MeshEncoding { kPlain, kDraco };

}  // namespace parkade
