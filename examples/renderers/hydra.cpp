// The sea as a generative procedural of Hydra 2 (hdGp, OpenUSD 23.11 and later), of the type PelagicSea, in a stage:
//
//   def GenerativeProcedural "Sea" (prepend apiSchemas = ["HydraGenerativeProceduralAPI"]) {
//       token primvars:hdGp:proceduralType = "PelagicSea"
//       asset primvars:shot = @./storm.toml@
//       double primvars:frame.timeSamples = { 1: 1, 96: 96 }
//   }
//
// Its child "sea" is a mesh with normals, slopeVariance and whitecapCoverage, whose points have a sample at either end of the shutter. A
// host that lets procedurals work beside it (asynchronously) shows the last sea until the next one is ready; a newer frame ends the work
// on an older one.
//
//   c++ -std=c++17 -O2 -fPIC -shared hydra.cpp -I$USD/include -L$USD/lib -lusd_hdGp -lusd_hd -lusd_pxOsd -lusd_sdf -lusd_vt -lusd_gf
//       -lusd_tf $(pkg-config --cflags --libs pelagic) -o libpelagic_hydra.so
//
// beside plugInfo.json, whose folder is in PXR_PLUGINPATH_NAME.
#include <pxr/base/gf/matrix4d.h>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/meshSchema.h>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/retainedDataSource.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/imaging/hd/xformSchema.h>
#include <pxr/imaging/hdGp/generativeProceduralPlugin.h>
#include <pxr/imaging/hdGp/generativeProceduralPluginRegistry.h>
#include <pxr/imaging/pxOsd/tokens.h>
#include <pxr/usd/sdf/assetPath.h>

#include <chrono>
#include <future>
#include <mutex>
#include <optional>

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

template <class T>
HdSampledDataSourceHandle retained(const T& value) {
    return HdRetainedTypedSampledDataSource<T>::New(value);
}

HdContainerDataSourceHandle primvar(const HdSampledDataSourceHandle& value, const TfToken& role) {
    return HdPrimvarSchema::Builder()
        .SetPrimvarValue(value)
        .SetInterpolation(HdPrimvarSchema::BuildInterpolationDataSource(HdPrimvarSchemaTokens->vertex))
        .SetRole(HdPrimvarSchema::BuildRoleDataSource(role))
        .Build();
}

HdContainerDataSourceHandle mesh_of(const std::shared_ptr<const SeaMesh>& sea) {
    const auto ints = [](const VtIntArray& of) {
        return HdRetainedTypedSampledDataSource<VtIntArray>::New(of);
    };
    const auto topology = HdMeshTopologySchema::Builder()
                              .SetFaceVertexCounts(ints(VtIntArray(sea->faces(), 4)))
                              .SetFaceVertexIndices(ints(VtIntArray(sea->corner.begin(), sea->corner.end())))
                              .Build();
    const auto mesh =
        HdMeshSchema::Builder()
            .SetTopology(topology)
            .SetSubdivisionScheme(HdRetainedTypedSampledDataSource<TfToken>::New(PxOsdOpenSubdivTokens->none))
            .Build();
    const GfVec3d origin(sea->origin_m[0], sea->origin_m[1], sea->origin_m[2]);
    const auto xform = HdXformSchema::Builder()
                           .SetMatrix(HdRetainedTypedSampledDataSource<GfMatrix4d>::New(
                               GfMatrix4d(1.0).SetTranslate(origin)))
                           .Build();
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

VtValue value_of(HdPrimvarsSchema primvars, const char* name) {
    const HdSampledDataSourceHandle value = primvars.GetPrimvar(TfToken(name)).GetPrimvarValue();
    return value ? value->GetValue(0.0f) : VtValue();
}

double number_of(const HdPrimvarsSchema& primvars, const char* name, double otherwise) {
    const VtValue value = VtValue::Cast<double>(value_of(primvars, name));
    return value.IsHolding<double>() ? value.UncheckedGet<double>() : otherwise;
}

SeaParameters parameters_of(const HdSceneIndexPrim& prim) {
    const HdPrimvarsSchema primvars = HdPrimvarsSchema::GetFromParent(prim.dataSource);
    SeaParameters asked;
    const VtValue shot = value_of(primvars, "shot");
    if (shot.IsHolding<SdfAssetPath>()) {
        const SdfAssetPath path = shot.UncheckedGet<SdfAssetPath>();
        asked.shot = path.GetResolvedPath().empty() ? path.GetAssetPath() : path.GetResolvedPath();
    } else if (shot.IsHolding<std::string>()) {
        asked.shot = shot.UncheckedGet<std::string>();
    }
    asked.frame = number_of(primvars, "frame", asked.frame);
    asked.finest_cell_m = number_of(primvars, "finestCell", asked.finest_cell_m);
    asked.threads = static_cast<int>(number_of(primvars, "threads", asked.threads));
    asked.shutter_open = number_of(primvars, "shutterOpen", asked.shutter_open);
    asked.shutter_close = number_of(primvars, "shutterClose", asked.shutter_close);
    return asked;
}

class PelagicSea final : public HdGpGenerativeProcedural {
  public:
    explicit PelagicSea(const SdfPath& path)
        : HdGpGenerativeProcedural(path), child_(path.AppendChild(TfToken("sea"))) {}
    ~PelagicSea() override { end_work(); }

    DependencyMap UpdateDependencies(const HdSceneIndexBaseRefPtr&) override {
        DependencyMap dependencies;
        dependencies[_GetProceduralPrimPath()] =
            HdDataSourceLocatorSet{HdPrimvarsSchema::GetDefaultLocator()};
        return dependencies;
    }

    bool AsyncBegin(bool is_async) override {
        is_async_ = is_async;
        return is_async;
    }

    ChildPrimTypeMap Update(const HdSceneIndexBaseRefPtr& scene, const ChildPrimTypeMap& before,
                            const DependencyMap&,
                            HdSceneIndexObserver::DirtiedPrimEntries* dirtied) override {
        const SeaParameters asked = parameters_of(scene->GetPrim(_GetProceduralPrimPath()));
        if (!asked_ || !(asked == *asked_)) {
            end_work();
            asked_ = asked;
            work_ = std::async(std::launch::async, [this, asked] { return make(asked); });
        }
        return is_async_ || !work_.valid() ? before : take(before, dirtied);
    }

    AsyncState AsyncUpdate(const ChildPrimTypeMap& before, ChildPrimTypeMap* children,
                           HdSceneIndexObserver::DirtiedPrimEntries* dirtied) override {
        if (!work_.valid()) return Finished;
        if (work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return Continuing;
        *children = take(before, dirtied);
        return FinishedWithNewChanges;
    }

    HdSceneIndexPrim GetChildPrim(const HdSceneIndexBaseRefPtr&, const SdfPath& path) override {
        const std::lock_guard<std::mutex> lock(lock_);
        if (path != child_ || !mesh_) return {};
        return {HdPrimTypeTokens->mesh, mesh_};
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

    ChildPrimTypeMap take(const ChildPrimTypeMap& before, HdSceneIndexObserver::DirtiedPrimEntries* dirtied) {
        const std::lock_guard<std::mutex> lock(lock_);
        mesh_ = work_.get();
        ChildPrimTypeMap children;
        if (!mesh_) return children;
        children[child_] = HdPrimTypeTokens->mesh;
        if (before.count(child_) > 0)
            dirtied->emplace_back(child_, HdDataSourceLocatorSet{HdMeshSchema::GetDefaultLocator(),
                                                                 HdPrimvarsSchema::GetDefaultLocator(),
                                                                 HdXformSchema::GetDefaultLocator()});
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
