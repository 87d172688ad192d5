// The sea as a generative procedural of Hydra 2 (hdGp, OpenUSD 23.11 and later), of the type PelagicSea, in a stage:
//
//   def GenerativeProcedural "Sea" (prepend apiSchemas = ["HydraGenerativeProceduralAPI"]) {
//       token primvars:hdGp:proceduralType = "PelagicSea"
//       asset primvars:shot = @./storm.toml@
//       double primvars:frame.timeSamples = { 1: 1, 96: 96 }
//   }
//
// Its child "sea" is a mesh with normals, slopeVariance and whitecapCoverage, whose points have a sample at either end of the shutter. It
// has the prim's material, visibility, purpose and transform. A host that lets procedurals work beside it (asynchronously) shows the last
// sea until the next one is ready; a newer frame ends the work on an older one. An edited shot file is read at the next update, as of
// another frame.
//
//   c++ -std=c++17 -O2 -fPIC -shared hydra.cpp -I$USD/include -L$USD/lib -lusd_hdGp -lusd_hd -lusd_hf -lusd_pxOsd -lusd_sdf -lusd_vt
//       -lusd_gf -lusd_tf $(pkg-config --cflags --libs pelagic) -o libpelagic_hydra.so
//
// beside plugInfo.json, whose folder is in PXR_PLUGINPATH_NAME. OpenUSD that was built with Python needs Python's include folder as well.
// Procedurals run where the host has a scene index for them: hdPrman and Houdini bring one; elsewhere, as in usdview,
// HDGP_INCLUDE_DEFAULT_RESOLVER=1 in the environment adds OpenUSD's own.
#include <pxr/base/gf/matrix4d.h>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/materialBindingsSchema.h>
#include <pxr/imaging/hd/meshSchema.h>
#include <pxr/imaging/hd/overlayContainerDataSource.h>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/purposeSchema.h>
#include <pxr/imaging/hd/retainedDataSource.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/imaging/hd/visibilitySchema.h>
#include <pxr/imaging/hd/xformSchema.h>
#include <pxr/imaging/hdGp/generativeProceduralPlugin.h>
#include <pxr/imaging/hdGp/generativeProceduralPluginRegistry.h>
#include <pxr/imaging/pxOsd/tokens.h>
#include <pxr/usd/sdf/assetPath.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "sea_mesh.h"

PXR_NAMESPACE_USING_DIRECTIVE

namespace {

VtVec3fArray vectors(const std::vector<float>& values) {
    VtVec3fArray array(values.size() / 3);
    GfVec3f* to = array.data();
    for (std::size_t i = 0; i < values.size(); i += 3)
        *to++ = GfVec3f(values[i], values[i + 1], values[i + 2]);
    return array;
}

// Positions at any time of the shutter, which Hydra counts in frames.
class MovingPoints final : public HdTypedSampledDataSource<VtVec3fArray> {
  public:
    HD_DECLARE_DATASOURCE(MovingPoints);

    explicit MovingPoints(std::shared_ptr<const SeaMesh> sea) : sea_(std::move(sea)) {}
    VtValue GetValue(Time time) override { return VtValue(GetTypedValue(time)); }
    VtVec3fArray GetTypedValue(Time time) override {
        return vectors(sea_->position_at(static_cast<double>(time)));
    }
    bool GetContributingSampleTimesForInterval(Time open, Time close, std::vector<Time>* times) override {
        if (open == close) return false;
        if (times) *times = {open, close};
        return true;
    }

  private:
    std::shared_ptr<const SeaMesh> sea_;
};

// The mesh's own matrix, and that of the prim, which may move and may be null.
class MovedMatrix final : public HdTypedSampledDataSource<GfMatrix4d> {
  public:
    HD_DECLARE_DATASOURCE(MovedMatrix);

    MovedMatrix(HdMatrixDataSourceHandle own, HdMatrixDataSourceHandle prim)
        : own_(std::move(own)), prim_(std::move(prim)) {}
    VtValue GetValue(Time time) override { return VtValue(GetTypedValue(time)); }
    GfMatrix4d GetTypedValue(Time time) override {
        const GfMatrix4d own = own_->GetTypedValue(time);
        return prim_ ? own * prim_->GetTypedValue(time) : own;
    }
    bool GetContributingSampleTimesForInterval(Time open, Time close, std::vector<Time>* times) override {
        return prim_ && prim_->GetContributingSampleTimesForInterval(open, close, times);
    }

  private:
    HdMatrixDataSourceHandle own_, prim_;
};

template <class T>
HdSampledDataSourceHandle retained(const T& value) {
    return HdRetainedTypedSampledDataSource<T>::New(value);
}

HdContainerDataSourceHandle primvar(const HdSampledDataSourceHandle& value, const TfToken& role) {
    return HdRetainedContainerDataSource::New(
        HdPrimvarSchemaTokens->primvarValue, value, HdPrimvarSchemaTokens->interpolation,
        retained(HdPrimvarSchemaTokens->vertex), HdPrimvarSchemaTokens->role, retained(role));
}

HdContainerDataSourceHandle mesh_of(const std::shared_ptr<const SeaMesh>& sea) {
    const auto topology = HdRetainedContainerDataSource::New(
        HdMeshTopologySchemaTokens->faceVertexCounts, retained(VtIntArray(sea->faces(), 4)),
        HdMeshTopologySchemaTokens->faceVertexIndices,
        retained(VtIntArray(sea->corner.begin(), sea->corner.end())));
    const auto mesh = HdRetainedContainerDataSource::New(HdMeshSchemaTokens->topology, topology,
                                                         HdMeshSchemaTokens->subdivisionScheme,
                                                         retained(PxOsdOpenSubdivTokens->none));
    const GfVec3d origin(sea->origin_m[0], sea->origin_m[1], sea->origin_m[2]);
    const auto xform = HdRetainedContainerDataSource::New(HdXformSchemaTokens->matrix,
                                                          retained(GfMatrix4d(1.0).SetTranslate(origin)));
    const VtFloatArray coverage(sea->coverage.begin(), sea->coverage.end());
    const auto primvars = HdRetainedContainerDataSource::New(
        HdPrimvarsSchemaTokens->points, primvar(MovingPoints::New(sea), HdPrimvarSchemaTokens->point),
        HdPrimvarsSchemaTokens->normals,
        primvar(retained(vectors(sea->normal)), HdPrimvarSchemaTokens->normal), TfToken("slopeVariance"),
        primvar(retained(vectors(sea->slope_variance)), TfToken()), TfToken("whitecapCoverage"),
        primvar(retained(coverage), TfToken()));
    return HdRetainedContainerDataSource::New(HdXformSchemaTokens->xform, xform, HdMeshSchemaTokens->mesh,
                                              mesh, HdPrimvarsSchemaTokens->primvars, primvars);
}

HdMatrixDataSourceHandle matrix_of(const HdContainerDataSourceHandle& prim) {
    return HdMatrixDataSource::Cast(HdContainerDataSource::Get(
        prim, HdDataSourceLocator(HdXformSchemaTokens->xform, HdXformSchemaTokens->matrix)));
}

// What the mesh has of its prim. Procedurals run on a flattened scene: what they make inherits nothing by itself.
HdDataSourceLocatorSet inherited() {
    return {HdMaterialBindingsSchema::GetDefaultLocator(), HdPurposeSchema::GetDefaultLocator(),
            HdVisibilitySchema::GetDefaultLocator(), HdXformSchema::GetDefaultLocator()};
}
HdContainerDataSourceHandle under(const HdContainerDataSourceHandle& prim,
                                  const HdContainerDataSourceHandle& mesh) {
    const auto of_prim = [&](const HdDataSourceLocator& at) { return HdContainerDataSource::Get(prim, at); };
    // The matrix holds all above it, for whoever flattens the scene once more.
    const auto xform = HdRetainedContainerDataSource::New(
        HdXformSchemaTokens->matrix, MovedMatrix::New(matrix_of(mesh), matrix_of(prim)),
        HdXformSchemaTokens->resetXformStack, retained(true));
    return HdOverlayContainerDataSource::New(
        HdRetainedContainerDataSource::New(
            HdXformSchemaTokens->xform, xform, HdMaterialBindingsSchemaTokens->materialBindings,
            of_prim(HdMaterialBindingsSchema::GetDefaultLocator()), HdPurposeSchemaTokens->purpose,
            of_prim(HdPurposeSchema::GetDefaultLocator()), HdVisibilitySchemaTokens->visibility,
            of_prim(HdVisibilitySchema::GetDefaultLocator())),
        mesh);
}

VtValue value_of(const HdSceneIndexPrim& prim, const char* primvar) {
    const HdSampledDataSourceHandle value = HdSampledDataSource::Cast(HdContainerDataSource::Get(
        prim.dataSource, HdDataSourceLocator(HdPrimvarsSchemaTokens->primvars, TfToken(primvar),
                                             HdPrimvarSchemaTokens->primvarValue)));
    return value ? value->GetValue(0.0f) : VtValue();
}

// Throws std::invalid_argument where it isn't finite.
double number_of(const HdSceneIndexPrim& prim, const char* primvar, double otherwise) {
    const VtValue value = VtValue::Cast<double>(value_of(prim, primvar));
    if (!value.IsHolding<double>()) return otherwise;
    const double number = value.UncheckedGet<double>();
    if (!std::isfinite(number))
        throw std::invalid_argument("primvars:" + std::string(primvar) + " is no finite number");
    return number;
}

SeaParameters parameters_of(const HdSceneIndexPrim& prim) {
    SeaParameters asked;
    const VtValue shot = value_of(prim, "shot");
    if (shot.IsHolding<SdfAssetPath>()) {
        const SdfAssetPath path = shot.UncheckedGet<SdfAssetPath>();
        asked.set_shot(path.GetResolvedPath().empty() ? path.GetAssetPath() : path.GetResolvedPath());
    } else if (shot.IsHolding<std::string>()) {
        asked.set_shot(shot.UncheckedGet<std::string>());
    }
    asked.frame = number_of(prim, "frame", asked.frame);
    asked.finest_cell_m = number_of(prim, "finestCell", asked.finest_cell_m);
    // More than any machine has are all.
    asked.threads = static_cast<int>(std::clamp(number_of(prim, "threads", asked.threads), -1.0, 65536.0));
    asked.shutter_open = number_of(prim, "shutterOpen", asked.shutter_open);
    asked.shutter_close = number_of(prim, "shutterClose", asked.shutter_close);
    return asked;
}

class PelagicSea final : public HdGpGenerativeProcedural {
  public:
    explicit PelagicSea(const SdfPath& path)
        : HdGpGenerativeProcedural(path), child_(path.AppendChild(TfToken("sea"))) {}
    ~PelagicSea() override { end_work(); }

    DependencyMap UpdateDependencies(const HdSceneIndexBaseRefPtr&) override {
        DependencyMap dependencies;
        HdDataSourceLocatorSet& of_prim = dependencies[_GetProceduralPrimPath()];
        of_prim = inherited();
        of_prim.insert(HdPrimvarsSchema::GetDefaultLocator());
        return dependencies;
    }

    bool AsyncBegin(bool is_async) override {
        is_async_ = is_async;
        return is_async;
    }

    // `dirtied` may be null.
    ChildPrimTypeMap Update(const HdSceneIndexBaseRefPtr& scene, const ChildPrimTypeMap& before,
                            const DependencyMap& changes,
                            HdSceneIndexObserver::DirtiedPrimEntries* dirtied) override {
        try {
            const SeaParameters asked = parameters_of(scene->GetPrim(_GetProceduralPrimPath()));
            if (!asked_ || !(asked == *asked_)) {
                end_work();
                asked_ = asked;
                work_ = std::async(std::launch::async, [this, asked] { return make(asked); });
            }
        } catch (const std::invalid_argument& error) {
            TF_RUNTIME_ERROR("Pelagic: %s", error.what());
            end_work();
            show(nullptr);
            return {};
        }
        const ChildPrimTypeMap children = is_async_ || !work_.valid() ? before : take(before, dirtied);
        const auto of_prim = changes.find(_GetProceduralPrimPath());
        if (!children.empty() && of_prim != changes.end() && of_prim->second.Intersects(inherited()))
            dirty(inherited(), before, dirtied);
        return children;
    }

    AsyncState AsyncUpdate(const ChildPrimTypeMap& before, ChildPrimTypeMap* children,
                           HdSceneIndexObserver::DirtiedPrimEntries* dirtied) override {
        if (!work_.valid()) return Finished;
        if (work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return Continuing;
        *children = take(before, dirtied);
        return FinishedWithNewChanges;
    }

    HdSceneIndexPrim GetChildPrim(const HdSceneIndexBaseRefPtr& scene, const SdfPath& path) override {
        HdContainerDataSourceHandle mesh;
        {
            const std::lock_guard<std::mutex> lock(lock_);
            mesh = mesh_;
        }
        if (path != child_ || !mesh) return {};
        return {HdPrimTypeTokens->mesh, under(scene->GetPrim(_GetProceduralPrimPath()).dataSource, mesh)};
    }

  private:
    // On a thread of its own. Null where it was stopped or has told why there is no sea.
    HdContainerDataSourceHandle make(const SeaParameters& asked) {
        try {
            const auto note = [](const char* sentence) { TF_WARN("Pelagic: %s", sentence); };
            return mesh_of(std::make_shared<const SeaMesh>(source_.mesh(asked, note)));
        } catch (const SeaStopped&) {
        } catch (const std::exception& error) {
            TF_RUNTIME_ERROR("Pelagic: %s", error.what());
        }
        return nullptr;
    }

    void end_work() {
        if (!work_.valid()) return;
        stop_.set(true);
        work_.get();
        stop_.set(false);
    }

    // Without a mesh the next update tries again: whatever was wrong may have been mended.
    void show(HdContainerDataSourceHandle mesh) {
        if (!mesh) asked_.reset();
        const std::lock_guard<std::mutex> lock(lock_);
        mesh_.swap(mesh);
    }

    void dirty(const HdDataSourceLocatorSet& locators, const ChildPrimTypeMap& before,
               HdSceneIndexObserver::DirtiedPrimEntries* dirtied) const {
        if (dirtied && before.count(child_) > 0) dirtied->emplace_back(child_, locators);
    }

    // Waits for the work, while other threads get the last mesh.
    ChildPrimTypeMap take(const ChildPrimTypeMap& before, HdSceneIndexObserver::DirtiedPrimEntries* dirtied) {
        const HdContainerDataSourceHandle mesh = work_.get();
        show(mesh);
        ChildPrimTypeMap children;
        if (!mesh) return children;
        children[child_] = HdPrimTypeTokens->mesh;
        dirty({HdMeshSchema::GetDefaultLocator(), HdPrimvarsSchema::GetDefaultLocator(),
               HdXformSchema::GetDefaultLocator()},
              before, dirtied);
        return children;
    }

    const SdfPath child_;
    SeaStop stop_;
    SeaSource source_{stop_};
    std::optional<SeaParameters> asked_;
    bool is_async_ = false;
    std::future<HdContainerDataSourceHandle> work_;
    std::mutex lock_;  // round the mesh, which several threads ask for
    HdContainerDataSourceHandle mesh_;
};

}  // namespace

// Not in the namespace above: plugInfo.json has its name.
class PelagicSeaPlugin final : public HdGpGenerativeProceduralPlugin {
  public:
    HdGpGenerativeProcedural* Construct(const SdfPath& path) override { return new PelagicSea(path); }
};

TF_REGISTRY_FUNCTION(TfType) {
    HdGpGenerativeProceduralPluginRegistry::Define<PelagicSeaPlugin>();
}
