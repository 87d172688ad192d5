// A stand-in for those headers of OpenUSD that examples/renderers/hydra.cpp includes, to compile and try it without OpenUSD: the declarations
// that it uses, written by us from their public documentation, and a host that keeps what it is told. Names are OpenUSD's; what stands behind
// them is as little as the procedural needs.
#pragma once

#include <any>
#include <cstdarg>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#define PXR_NAMESPACE_USING_DIRECTIVE using namespace pxr;

namespace pxr {

class TfToken {
  public:
    TfToken() = default;
    explicit TfToken(const char* text) : text_(text) {}
    const std::string& GetString() const { return text_; }
    bool operator==(const TfToken& other) const { return text_ == other.text_; }
    bool operator<(const TfToken& other) const { return text_ < other.text_; }

  private:
    std::string text_;
};

class SdfPath {
  public:
    SdfPath() = default;
    explicit SdfPath(std::string text) : text_(std::move(text)) {}
    SdfPath AppendChild(const TfToken& name) const { return SdfPath(text_ + "/" + name.GetString()); }
    const std::string& GetString() const { return text_; }
    bool operator==(const SdfPath& other) const { return text_ == other.text_; }
    bool operator!=(const SdfPath& other) const { return text_ != other.text_; }

  private:
    std::string text_;
};

struct TfHash {
    std::size_t operator()(const SdfPath& path) const { return std::hash<std::string>()(path.GetString()); }
};
template <class Key, class Value, class Hash>
class TfDenseHashMap : public std::unordered_map<Key, Value, Hash> {};

class SdfAssetPath {
  public:
    explicit SdfAssetPath(std::string path, std::string resolved = {})
        : path_(std::move(path)), resolved_(std::move(resolved)) {}
    const std::string& GetAssetPath() const { return path_; }
    const std::string& GetResolvedPath() const { return resolved_; }

  private:
    std::string path_, resolved_;
};

class GfVec3f {
  public:
    GfVec3f() = default;
    GfVec3f(float x, float y, float z) : of_{x, y, z} {}
    float operator[](std::size_t i) const { return of_[i]; }

  private:
    float of_[3];
};
class GfVec3d {
  public:
    GfVec3d(double x, double y, double z) : of_{x, y, z} {}
    double operator[](std::size_t i) const { return of_[i]; }

  private:
    double of_[3];
};
class GfMatrix4d {
  public:
    explicit GfMatrix4d(double diagonal) {
        for (std::size_t i = 0; i < 4; ++i) of_[i][i] = diagonal;
    }
    GfMatrix4d& SetTranslate(const GfVec3d& by) {
        for (std::size_t i = 0; i < 3; ++i) of_[3][i] = by[i];
        return *this;
    }
    const double* operator[](std::size_t row) const { return of_[row]; }

  private:
    double of_[4][4] = {};
};

template <class T>
class VtArray : public std::vector<T> {
  public:
    using std::vector<T>::vector;
};
using VtIntArray = VtArray<int>;
using VtFloatArray = VtArray<float>;
using VtVec3fArray = VtArray<GfVec3f>;

class VtValue {
  public:
    VtValue() = default;
    template <class T>
    explicit VtValue(const T& value) : value_(value) {}
    template <class T>
    bool IsHolding() const {
        return std::any_cast<T>(&value_) != nullptr;
    }
    template <class T>
    const T& UncheckedGet() const {
        return *std::any_cast<T>(&value_);
    }
    // Of numbers to double alone.
    template <class T>
    static VtValue Cast(const VtValue& value) {
        if (value.IsHolding<double>()) return value;
        if (value.IsHolding<float>()) return VtValue(static_cast<T>(value.UncheckedGet<float>()));
        if (value.IsHolding<int>()) return VtValue(static_cast<T>(value.UncheckedGet<int>()));
        return {};
    }

  private:
    std::any value_;
};

// ---- Data sources

#define HD_DECLARE_DATASOURCE(type)                                     \
    using Handle = std::shared_ptr<type>;                               \
    template <class... Arguments>                                       \
    static Handle New(Arguments&&... arguments) {                       \
        return Handle(new type(std::forward<Arguments>(arguments)...)); \
    }

class HdDataSourceBase {
  public:
    virtual ~HdDataSourceBase() = default;
};
using HdDataSourceBaseHandle = std::shared_ptr<HdDataSourceBase>;

class HdContainerDataSource : public HdDataSourceBase {
  public:
    virtual HdDataSourceBaseHandle Get(const TfToken& name) = 0;
};
using HdContainerDataSourceHandle = std::shared_ptr<HdContainerDataSource>;

class HdSampledDataSource : public HdDataSourceBase {
  public:
    using Time = float;
    virtual VtValue GetValue(Time time) = 0;
    virtual bool GetContributingSampleTimesForInterval(Time open, Time close, std::vector<Time>* times) = 0;
};
using HdSampledDataSourceHandle = std::shared_ptr<HdSampledDataSource>;

template <class T>
class HdTypedSampledDataSource : public HdSampledDataSource {
  public:
    virtual T GetTypedValue(Time time) = 0;
};
using HdIntArrayDataSourceHandle = std::shared_ptr<HdTypedSampledDataSource<VtIntArray>>;
using HdTokenDataSourceHandle = std::shared_ptr<HdTypedSampledDataSource<TfToken>>;
using HdMatrixDataSourceHandle = std::shared_ptr<HdTypedSampledDataSource<GfMatrix4d>>;

template <class T>
class HdRetainedTypedSampledDataSource : public HdTypedSampledDataSource<T> {
  public:
    using Handle = std::shared_ptr<HdRetainedTypedSampledDataSource<T>>;
    static Handle New(const T& value) { return Handle(new HdRetainedTypedSampledDataSource<T>(value)); }
    explicit HdRetainedTypedSampledDataSource(const T& value) : value_(value) {}
    VtValue GetValue(float) override { return VtValue(value_); }
    T GetTypedValue(float) override { return value_; }
    bool GetContributingSampleTimesForInterval(float, float, std::vector<float>*) override { return false; }

  private:
    T value_;
};

class HdRetainedContainerDataSource : public HdContainerDataSource {
  public:
    using Handle = std::shared_ptr<HdRetainedContainerDataSource>;
    static Handle New() { return Handle(new HdRetainedContainerDataSource()); }
    template <class... More>
    static Handle New(const TfToken& name, const HdDataSourceBaseHandle& value, const More&... more) {
        const Handle made = New(more...);
        if (value) made->children_[name] = value;
        return made;
    }
    HdDataSourceBaseHandle Get(const TfToken& name) override {
        const auto found = children_.find(name);
        return found == children_.end() ? nullptr : found->second;
    }

  private:
    std::map<TfToken, HdDataSourceBaseHandle> children_;
};

class HdDataSourceLocator {
  public:
    explicit HdDataSourceLocator(const TfToken& first) : first_(first) {}
    const TfToken& GetFirstElement() const { return first_; }

  private:
    TfToken first_;
};
class HdDataSourceLocatorSet : public std::vector<HdDataSourceLocator> {
  public:
    using std::vector<HdDataSourceLocator>::vector;
};

// ---- Tokens and schemas

inline const struct HdPrimTypeTokensOfStandIn { TfToken mesh{"mesh"}; } hd_prim_types;
inline const auto* const HdPrimTypeTokens = &hd_prim_types;
inline const struct HdMeshTokensOfStandIn {
    TfToken mesh{"mesh"}, topology{"topology"}, subdivisionScheme{"subdivisionScheme"};
} hd_mesh_tokens;
inline const auto* const HdMeshSchemaTokens = &hd_mesh_tokens;
inline const struct HdTopologyTokensOfStandIn {
    TfToken faceVertexCounts{"faceVertexCounts"}, faceVertexIndices{"faceVertexIndices"};
} hd_topology_tokens;
inline const auto* const HdMeshTopologySchemaTokens = &hd_topology_tokens;
inline const struct HdXformTokensOfStandIn { TfToken xform{"xform"}, matrix{"matrix"}; } hd_xform_tokens;
inline const auto* const HdXformSchemaTokens = &hd_xform_tokens;
inline const struct HdPrimvarsTokensOfStandIn {
    TfToken primvars{"primvars"}, points{"points"}, normals{"normals"};
} hd_primvars_tokens;
inline const auto* const HdPrimvarsSchemaTokens = &hd_primvars_tokens;
inline const struct HdPrimvarTokensOfStandIn {
    TfToken primvarValue{"primvarValue"}, interpolation{"interpolation"}, role{"role"}, vertex{"vertex"},
        point{"point"}, normal{"normal"};
} hd_primvar_tokens;
inline const auto* const HdPrimvarSchemaTokens = &hd_primvar_tokens;
inline const struct PxOsdTokensOfStandIn { TfToken none{"none"}; } px_osd_tokens;
inline const auto* const PxOsdOpenSubdivTokens = &px_osd_tokens;

class HdPrimvarSchema {
  public:
    explicit HdPrimvarSchema(HdContainerDataSourceHandle container) : container_(std::move(container)) {}
    HdSampledDataSourceHandle GetPrimvarValue() const {
        return container_ ? std::dynamic_pointer_cast<HdSampledDataSource>(
                                container_->Get(HdPrimvarSchemaTokens->primvarValue))
                          : nullptr;
    }
    static HdTokenDataSourceHandle BuildInterpolationDataSource(const TfToken& word) {
        return HdRetainedTypedSampledDataSource<TfToken>::New(word);
    }
    static HdTokenDataSourceHandle BuildRoleDataSource(const TfToken& word) {
        return HdRetainedTypedSampledDataSource<TfToken>::New(word);
    }
    class Builder {
      public:
        Builder& SetPrimvarValue(const HdSampledDataSourceHandle& value) { return value_ = value, *this; }
        Builder& SetInterpolation(const HdTokenDataSourceHandle& word) {
            return interpolation_ = word, *this;
        }
        Builder& SetRole(const HdTokenDataSourceHandle& word) { return role_ = word, *this; }
        HdContainerDataSourceHandle Build() {
            return HdRetainedContainerDataSource::New(HdPrimvarSchemaTokens->primvarValue, value_,
                                                      HdPrimvarSchemaTokens->interpolation, interpolation_,
                                                      HdPrimvarSchemaTokens->role, role_);
        }

      private:
        HdSampledDataSourceHandle value_;
        HdTokenDataSourceHandle interpolation_, role_;
    };

  private:
    HdContainerDataSourceHandle container_;
};

class HdPrimvarsSchema {
  public:
    static HdPrimvarsSchema GetFromParent(const HdContainerDataSourceHandle& prim) {
        return HdPrimvarsSchema(prim ? std::dynamic_pointer_cast<HdContainerDataSource>(
                                           prim->Get(HdPrimvarsSchemaTokens->primvars))
                                     : nullptr);
    }
    static const HdDataSourceLocator& GetDefaultLocator() {
        static const HdDataSourceLocator locator(HdPrimvarsSchemaTokens->primvars);
        return locator;
    }
    HdPrimvarSchema GetPrimvar(const TfToken& name) {
        return HdPrimvarSchema(
            container_ ? std::dynamic_pointer_cast<HdContainerDataSource>(container_->Get(name)) : nullptr);
    }

  private:
    explicit HdPrimvarsSchema(HdContainerDataSourceHandle container) : container_(std::move(container)) {}
    HdContainerDataSourceHandle container_;
};

class HdMeshTopologySchema {
  public:
    class Builder {
      public:
        Builder& SetFaceVertexCounts(const HdIntArrayDataSourceHandle& counts) {
            return counts_ = counts, *this;
        }
        Builder& SetFaceVertexIndices(const HdIntArrayDataSourceHandle& indices) {
            return indices_ = indices, *this;
        }
        HdContainerDataSourceHandle Build() {
            return HdRetainedContainerDataSource::New(HdMeshTopologySchemaTokens->faceVertexCounts, counts_,
                                                      HdMeshTopologySchemaTokens->faceVertexIndices,
                                                      indices_);
        }

      private:
        HdIntArrayDataSourceHandle counts_, indices_;
    };
};

class HdMeshSchema {
  public:
    static const HdDataSourceLocator& GetDefaultLocator() {
        static const HdDataSourceLocator locator(HdMeshSchemaTokens->mesh);
        return locator;
    }
    class Builder {
      public:
        Builder& SetTopology(const HdContainerDataSourceHandle& topology) {
            return topology_ = topology, *this;
        }
        Builder& SetSubdivisionScheme(const HdTokenDataSourceHandle& scheme) {
            return scheme_ = scheme, *this;
        }
        HdContainerDataSourceHandle Build() {
            return HdRetainedContainerDataSource::New(HdMeshSchemaTokens->topology, topology_,
                                                      HdMeshSchemaTokens->subdivisionScheme, scheme_);
        }

      private:
        HdContainerDataSourceHandle topology_;
        HdTokenDataSourceHandle scheme_;
    };
};

class HdXformSchema {
  public:
    static const HdDataSourceLocator& GetDefaultLocator() {
        static const HdDataSourceLocator locator(HdXformSchemaTokens->xform);
        return locator;
    }
    class Builder {
      public:
        Builder& SetMatrix(const HdMatrixDataSourceHandle& matrix) { return matrix_ = matrix, *this; }
        HdContainerDataSourceHandle Build() {
            return HdRetainedContainerDataSource::New(HdXformSchemaTokens->matrix, matrix_);
        }

      private:
        HdMatrixDataSourceHandle matrix_;
    };
};

// ---- The scene and its procedurals

struct HdSceneIndexPrim {
    TfToken primType;
    HdContainerDataSourceHandle dataSource;
};
class HdSceneIndexBase {
  public:
    virtual ~HdSceneIndexBase() = default;
    virtual HdSceneIndexPrim GetPrim(const SdfPath& path) const = 0;
};
using HdSceneIndexBaseRefPtr = std::shared_ptr<HdSceneIndexBase>;

struct HdSceneIndexObserver {
    struct DirtiedPrimEntry {
        DirtiedPrimEntry(const SdfPath& path, const HdDataSourceLocatorSet& locators)
            : primPath(path), dirtyLocators(locators) {}
        SdfPath primPath;
        HdDataSourceLocatorSet dirtyLocators;
    };
    using DirtiedPrimEntries = std::vector<DirtiedPrimEntry>;
};

class HdGpGenerativeProcedural {
  public:
    using DependencyMap = TfDenseHashMap<SdfPath, HdDataSourceLocatorSet, TfHash>;
    using ChildPrimTypeMap = TfDenseHashMap<SdfPath, TfToken, TfHash>;
    enum AsyncState { Continuing = 0, Finished, ContinuingWithNewChanges, FinishedWithNewChanges };

    explicit HdGpGenerativeProcedural(const SdfPath& path) : path_(path) {}
    virtual ~HdGpGenerativeProcedural() = default;
    virtual DependencyMap UpdateDependencies(const HdSceneIndexBaseRefPtr& scene) = 0;
    virtual ChildPrimTypeMap Update(const HdSceneIndexBaseRefPtr& scene, const ChildPrimTypeMap& before,
                                    const DependencyMap& dirtied,
                                    HdSceneIndexObserver::DirtiedPrimEntries* out) = 0;
    virtual HdSceneIndexPrim GetChildPrim(const HdSceneIndexBaseRefPtr& scene, const SdfPath& path) = 0;
    virtual bool AsyncBegin(bool) { return false; }
    virtual AsyncState AsyncUpdate(const ChildPrimTypeMap&, ChildPrimTypeMap*,
                                   HdSceneIndexObserver::DirtiedPrimEntries*) {
        return Finished;
    }

  protected:
    const SdfPath& _GetProceduralPrimPath() { return path_; }

  private:
    const SdfPath path_;
};

class HdGpGenerativeProceduralPlugin {
  public:
    virtual ~HdGpGenerativeProceduralPlugin() = default;
    virtual HdGpGenerativeProcedural* Construct(const SdfPath& path) = 0;
};

// What the host has been told.
struct HydraStandIn {
    std::vector<std::unique_ptr<HdGpGenerativeProceduralPlugin>> plugins;
    std::mutex lock;
    std::vector<std::string> log;
};
inline HydraStandIn& hydra_stand_in() {
    static HydraStandIn host;
    return host;
}

class HdGpGenerativeProceduralPluginRegistry {
  public:
    template <class Plugin>
    static void Define() {
        hydra_stand_in().plugins.push_back(std::make_unique<Plugin>());
    }
};

inline void hydra_stand_in_log(const char* format, ...) {
    char text[4096];
    va_list words;
    va_start(words, format);
    std::vsnprintf(text, sizeof text, format, words);
    va_end(words);
    const std::lock_guard<std::mutex> lock(hydra_stand_in().lock);
    hydra_stand_in().log.emplace_back(text);
}

}  // namespace pxr

#define TF_WARN pxr::hydra_stand_in_log
#define TF_RUNTIME_ERROR pxr::hydra_stand_in_log
// Runs when the program is loaded.
#define TF_REGISTRY_FUNCTION(type)                                                  \
    static void register_for_stand_in();                                            \
    static const bool is_registered_for_stand_in = (register_for_stand_in(), true); \
    static void register_for_stand_in()
