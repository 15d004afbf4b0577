#include "recognition/look_alikes.h"

#include <algorithm>
#include <memory>

#include "absl/status/status.h"

namespace graspdb::recognition {
namespace {

struct Known {
  const TaughtStablePose* pose = nullptr;
  std::string object;
  std::shared_ptr<const SurfaceModel> model;
};

absl::StatusOr<std::vector<Known>> ModelsOf(const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                                            const IsCancelled& is_cancelled) {
  std::vector<Known> out;
  for (const auto& [name, pose] : *catalogue.stable_poses) {
    if (is_cancelled()) return absl::CancelledError("cancelled while loading models");
    const auto posed =
        std::ranges::find_if(pose->views, [](const auto& view) { return view->shares_frame; });
    if (posed == pose->views.end()) continue;
    auto model = clouds.LoadModel(**posed, *pose);
    if (!model.ok()) return model.status();
    if (*model) out.push_back({pose.get(), (*posed)->object, *std::move(model)});
  }
  std::ranges::sort(out, {}, [](const Known& known) { return known.pose->name; });
  return out;
}

}  // namespace

absl::StatusOr<CatalogueSimilarity> FindLookAlikes(const CatalogueSnapshot& catalogue,
                                                   ViewClouds& clouds, const std::string& object,
                                                   const IsCancelled& is_cancelled) {
  const auto models = ModelsOf(catalogue, clouds, is_cancelled);
  if (!models.ok()) return models.status();
  const auto is_selected = [&](const Known& known) {
    return object.empty() || known.object == object;
  };
  CatalogueSimilarity out;
  for (auto a = models->begin(); a != models->end(); ++a) {
    if (is_cancelled()) return absl::CancelledError("cancelled while comparing stable poses");
    if (is_selected(*a)) {
      const FoundSymmetry found = FindSymmetry(*a->model);
      if (found.order != 1 || a->pose->symmetry_order != 1) {
        out.symmetries.push_back({a->pose->name, a->pose->symmetry_order, found});
      }
    }
    for (auto b = a + 1; b != models->end(); ++b) {
      if (!is_selected(*a) && !is_selected(*b)) continue;
      const auto similarity = FindShapeSimilarity(*a->model, *b->model);
      if (!similarity) continue;
      const double alike = std::max(AlikeM(*a->model), AlikeM(*b->model));
      out.pairs.push_back(
          {a->pose->name, b->pose->name, *similarity, similarity->gap.largest_m > alike});
    }
  }
  return out;
}

}  // namespace graspdb::recognition
