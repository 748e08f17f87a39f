#include "mapping/networks/layer_plan.h"

#include <algorithm>
#include <utility>

#include "mapping/networks/onnx_convolution.h"
#include "mapping/networks/simple_layers.h"

namespace parkade {
namespace {

/// Goes through the nodes in order. What is done to a layer's output right away (Relu, Add) becomes
/// part of it. Images are numbered at first, the input is 0.
class Planner {
 public:
  explicit Planner(const OnnxGraph& graph) : graph_(graph), is_done_(graph.nodes.size(), false) {
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
      for (const std::string& input : graph.nodes[i].inputs) users_[input].push_back(i);
    images_[graph.input] = {0, 0};
  }

  std::optional<LayerPlan> Plan() && {
    for (std::size_t i = 0; i < graph_.nodes.size(); ++i)
      if (!is_done_[i] && !PlanNode(graph_.nodes[i])) return std::nullopt;
    const auto output = images_.find(graph_.output);
    if (plan_.steps.empty() || output == images_.end() ||
        output->second.number != plan_.steps.back().output)
      return std::nullopt;
    return std::move(plan_);
  }

 private:
  struct Image {
    int number = 0;
    int channels = 0;  // 0: of the input that nothing has been done to yet
  };

  bool PlanNode(const OnnxNode& node) {
    const Image* input = node.inputs.empty() ? nullptr : FindImage(node.inputs[0]);
    if (input == nullptr) return false;
    if (node.operation == "Conv") return PlanConvolution(node, *input);
    if (node.operation == "Mul" && node.inputs[0] == graph_.input) return PlanInputFactor(node);
    if (input->channels == 0) return false;
    if (node.operation == "Resize") return PlanDoubling(node, *input);
    std::unique_ptr<Layer> layer = MakeElementLayer(node);
    if (layer == nullptr) return false;
    AddStep({.layer = std::move(layer), .input = input->number}, input->channels, node.outputs[0]);
    return true;
  }

  bool PlanConvolution(const OnnxNode& node, Image input) {
    std::optional<Convolution> convolution = ReadConvolution(graph_, node);
    if (!convolution) return false;
    std::string name = node.outputs[0];
    if (const OnnxNode* rectifier = TakeOnlyUser(name, "Relu")) {
      convolution->is_rectified = true;
      name = rectifier->outputs[0];
    }
    LayerStep step{.layer = MakeLayer(*convolution), .input = input.number};
    if (input.number == 0) {
      if (plan_.input_channels != 0) return false;
      plan_.input_channels = input.channels = convolution->inputs;
      plan_.is_input_dense = step.layer->TakesAnyStep();
    }
    if (input.channels != convolution->inputs) return false;
    step.added = TakeAdded(name, convolution->outputs);
    AddStep(std::move(step), convolution->outputs, name);
    return true;
  }

  bool PlanDoubling(const OnnxNode& node, const Image& input) {
    const auto word = [&](std::string_view name) {
      const auto found = node.words.find(name);
      return found == node.words.end() ? "" : found->second;
    };
    const OnnxTensor* scales =
        node.inputs.size() == 3 ? graph_.FindTensor(node.inputs[2]) : nullptr;
    if (scales == nullptr || scales->values != std::vector<float>{1, 1, 2, 2} ||
        word("mode") != "linear" || word("coordinate_transformation_mode") != "half_pixel")
      return false;
    std::string name = node.outputs[0];
    LayerStep step{.layer = MakeDoublingLayer(), .input = input.number};
    step.added = TakeAdded(name, input.channels);
    AddStep(std::move(step), input.channels, name);
    return true;
  }

  /// The input times a number is still the input, for all who use it.
  bool PlanInputFactor(const OnnxNode& node) {
    const std::optional<float> factor = FindNumber(node);
    if (!factor || users_[graph_.input].size() != 1) return false;
    plan_.input_factor = *factor;
    images_[node.outputs[0]] = {0, 0};
    return true;
  }

  std::unique_ptr<Layer> MakeElementLayer(const OnnxNode& node) const {
    if (node.operation == "Tanh") return MakeTanhLayer();
    const std::optional<float> number = FindNumber(node);
    if (node.operation == "Mul" && number) return MakeScaleLayer(*number);
    if (node.operation == "Div" && number && *number != 0) return MakeScaleLayer(1 / *number);
    return nullptr;
  }

  /// The constant that is the second input.
  std::optional<float> FindNumber(const OnnxNode& node) const {
    const OnnxTensor* tensor =
        node.inputs.size() == 2 ? graph_.FindTensor(node.inputs[1]) : nullptr;
    return tensor != nullptr && tensor->values.size() == 1 ? std::optional(tensor->values[0])
                                                           : std::nullopt;
  }

  const Image* FindImage(const std::string& name) const {
    const auto found = images_.find(name);
    return found == images_.end() ? nullptr : &found->second;
  }

  /// The node that alone uses an image, if it does this operation; it is done then.
  const OnnxNode* TakeOnlyUser(const std::string& name, std::string_view operation) {
    const std::vector<std::size_t>& users = users_[name];
    if (users.size() != 1 || graph_.nodes[users[0]].operation != operation) return nullptr;
    is_done_[users[0]] = true;
    return &graph_.nodes[users[0]];
  }

  /// What is added to image `name` alone, -1 where nothing is; the name is the sum's from then on.
  int TakeAdded(std::string& name, int channels) {
    const std::vector<std::size_t>& users = users_[name];
    if (users.size() != 1 || graph_.nodes[users[0]].operation != "Add") return -1;
    const std::vector<std::string>& inputs = graph_.nodes[users[0]].inputs;
    const Image* other = inputs.size() == 2 ? FindImage(inputs[inputs[0] == name]) : nullptr;
    if (other == nullptr || other->number == 0 || other->channels != channels) return -1;
    name = TakeOnlyUser(name, "Add")->outputs[0];
    return other->number;
  }

  void AddStep(LayerStep step, int channels, const std::string& name) {
    step.output = static_cast<int>(plan_.steps.size()) + 1;
    images_[name] = {step.output, channels};
    plan_.steps.push_back(std::move(step));
  }

  const OnnxGraph& graph_;
  std::vector<bool> is_done_;                              // of nodes that became part of a layer
  std::map<std::string, std::vector<std::size_t>> users_;  // nodes that take an image
  std::map<std::string, Image> images_;
  LayerPlan plan_;
};

/// Images share buffers: one is free again after the last layer that takes its image.
void ShareBuffers(LayerPlan& plan) {
  std::vector<std::size_t> last_use(plan.steps.size() + 1, 0);
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    for (const int image : {plan.steps[i].input, plan.steps[i].added})
      if (image >= 0) last_use[static_cast<std::size_t>(image)] = i;
  std::vector<int> buffer_of(plan.steps.size() + 1, 0), idle;
  plan.num_buffers = 1;
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    LayerStep& step = plan.steps[i];
    if (idle.empty()) idle.push_back(plan.num_buffers++);
    const int output = idle.back();
    idle.pop_back();
    buffer_of[static_cast<std::size_t>(step.output)] = output;
    for (int* image : {&step.input, &step.added}) {
      if (*image < 0) continue;
      const auto number = static_cast<std::size_t>(*image);
      *image = buffer_of[number];
      if (last_use[number] == i && std::exchange(last_use[number], SIZE_MAX) == i)
        idle.push_back(*image);
    }
    step.output = output;
  }
}

}  // namespace

std::optional<LayerPlan> PlanLayers(const OnnxGraph& graph) {
  std::optional<LayerPlan> plan = Planner(graph).Plan();
  if (plan) ShareBuffers(*plan);
  return plan;
}

}  // namespace parkade
