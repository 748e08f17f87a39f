#include "tests/mapping/worlds/tiny_onnx.h"

namespace parkade {
namespace {

// Protocol buffers, as far as onnx.proto needs them here: numbers and things with a length.
std::string Varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 128; value >>= 7) bytes.push_back(static_cast<char>(value | 128));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}

std::string Number(int field, std::uint64_t value) {
  return Varint(static_cast<std::uint64_t>(field) << 3) + Varint(value);
}

std::string Bytes(int field, const std::string& content) {
  return Varint((static_cast<std::uint64_t>(field) << 3) | 2) + Varint(content.size()) + content;
}

std::string Tensor(const std::string& name, const std::vector<std::uint64_t>& sizes,
                   const std::vector<float>& values) {
  std::string tensor;
  for (const std::uint64_t size : sizes) tensor += Number(1, size);
  const std::string raw(reinterpret_cast<const char*>(values.data()),
                        values.size() * sizeof(float));
  return tensor + Number(2, 1) + Bytes(8, name) + Bytes(9, raw);
}

std::string ValueInfo(const std::string& name, const std::vector<std::uint64_t>& sizes) {
  std::string shape;
  for (const std::uint64_t size : sizes)
    shape += Bytes(1, size > 0 ? Number(1, size) : Bytes(2, "open"));
  return Bytes(1, name) + Bytes(2, Bytes(1, Number(1, 1) + Bytes(2, shape)));
}

}  // namespace

std::string TinyOnnx(const std::vector<float>& weights, const std::vector<float>& biases, int width,
                     int height) {
  const std::uint64_t channels = biases.size(), w = static_cast<std::uint64_t>(width),
                      h = static_cast<std::uint64_t>(height);
  const std::string kernel_shape =
      Bytes(1, "kernel_shape") + Number(8, 1) + Number(8, 1) + Number(20, 7);
  const std::string node = Bytes(1, "image") + Bytes(1, "weights") + Bytes(1, "biases") +
                           Bytes(2, "log_odds") + Bytes(3, "convolution") + Bytes(4, "Conv") +
                           Bytes(5, kernel_shape);
  const std::string graph = Bytes(1, node) + Bytes(2, "tiny") +
                            Bytes(5, Tensor("weights", {channels, 3, 1, 1}, weights)) +
                            Bytes(5, Tensor("biases", {channels}, biases)) +
                            Bytes(11, ValueInfo("image", {1, 3, h, w})) +
                            Bytes(12, ValueInfo("log_odds", {1, channels, h, w}));
  return Number(1, 6) + Bytes(7, graph) + Bytes(8, Bytes(1, "") + Number(2, 11));
}

}  // namespace parkade
