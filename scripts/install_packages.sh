#!/usr/bin/env bash
# Installs what Parkade needs on Debian 12, and says what it installs. Idempotent.
#   scripts/install_packages.sh             to build, run and test
#   scripts/install_packages.sh --build     to build and run
#   scripts/install_packages.sh --runtime   only to run an installed build
set -euo pipefail

build_packages=(
  # toolchain
  build-essential cmake ninja-build ccache pkg-config ca-certificates curl git python3
  # what the program is made of
  libeigen3-dev libopencv-dev libopencv-contrib-dev libceres-dev libsuitesparse-dev libpcl-dev libcgal-dev libtinygltf-dev libdraco-dev
  libgeotiff-dev libtiff-dev libpugixml-dev libgeographiclib-dev libcpp-httplib-dev libssl-dev libcurl4-openssl-dev nlohmann-json3-dev libyaml-cpp-dev
  libspdlog-dev libcli11-dev
  libsqlite3-dev libarchive-dev libzstd-dev liblz4-dev libxxhash-dev libbz2-dev zlib1g-dev libturbojpeg0-dev libpng-dev libprotobuf-dev libfastcdr-dev
  libavcodec-dev libavutil-dev libswscale-dev
  # Debian's Ceres would otherwise run on ATLAS, which is several times slower
  libopenblas0-pthread
  # the drive simulator, and what CMake looks for to configure the tests
  libembree-dev libgtest-dev libbenchmark-dev
)
test_packages=(
  slurm-wlm munge strace time gdal-bin python3-rosbag python3-sensor-msgs python3-nav-msgs python3-geometry-msgs python3-tf2-msgs chromium clang-format
  # the site that is shipped for nginx, and the Debian package
  nginx openssl lintian
  # clang-tidy, and the fuzzer of the log readers
  clang-14 clang-tidy-14 libclang-rt-14-dev
)
runtime_packages=(
  libopencv-core406 libopencv-imgproc406 libopencv-imgcodecs406 libopencv-features2d406 libopencv-calib3d406
  libopencv-video406 libopencv-dnn406 libceres3 libcholmod3 libopenblas0-pthread libpcl-common1.13 libpcl-kdtree1.13 libpcl-search1.13
  libpcl-sample-consensus1.13 libpcl-filters1.13 libpcl-segmentation1.13 libpcl-features1.13 libpcl-octree1.13
  libtinygltf2d libdraco7 libgeotiff5 libtiffxx6 libpugixml1v5 libgeographiclib23 libcpp-httplib0.11 libyaml-cpp0.7 libspdlog1.10
  libsqlite3-0 libcurl4 libarchive13 libzstd1 liblz4-1 libbz2-1.0 zlib1g libjpeg62-turbo libavcodec59 libavutil57 libswscale6 libprotobuf32 libfastcdr1 libgmp10 libmpfr6 curl
)

case "${1:-}" in
  "") wanted=("${build_packages[@]}" "${test_packages[@]}") ;;
  --build) wanted=("${build_packages[@]}") ;;
  --runtime) wanted=("${runtime_packages[@]}") ;;
  *) echo "usage: $0 [--build | --runtime]" >&2; exit 2 ;;
esac

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

missing=()
for package in "${wanted[@]}"; do
  is_installed "$package" || missing+=("$package")
done
# Node.js from wherever it came; Debian's is new enough (18).
if [ "${1:-}" != --runtime ]; then
  command -v node > /dev/null || missing+=(nodejs)
  command -v npm > /dev/null || missing+=(npm)
fi

if [ ${#missing[@]} -eq 0 ]; then
  echo "install_packages: everything is here"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo > /dev/null || { echo "install_packages: needs root or sudo for: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "install_packages: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}"
