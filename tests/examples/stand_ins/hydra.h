// A stand-in for those headers of OpenUSD that examples/renderers/hydra.cpp includes, to compile and try it without OpenUSD: the declarations
// that it uses, written by us from their public documentation, and a host that keeps what it is told. Names are OpenUSD's; what stands behind
// them is as little as the procedural needs.
#pragma once

#include <any>
#include <cstdarg>
#include <cstdio>
#include <functional>
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
    double* operator[](std::size_t row) { return of_[row]; }
    const double* operator[](std::size_t row) const { return of_[row]; }
    // Of rows: the first one moves first.
    GfMatrix4d operator*(const GfMatrix4d& next) const {
        GfMatrix4d both(0.0);
        for (std::size_t i = 0; i < 16; ++i)
            for (std::size_t k = 0; k < 4; ++k) both[i / 4][i % 4] += of_[i / 4][k] * next[k][i % 4];
        return both;
    }

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

class HdDataSourceLocator {
  public:
    template <class... Names>
    explicit HdDataSourceLocator(const Names&... names) : names_{names...} {}
    std::size_t GetElementCount() const { return names_.size(); }
    const TfToken& GetElement(std::size_t i) const { return names_.at(i); }
    const TfToken& GetFirstElement() const { return names_.at(0); }

  private:
    std::vector<TfToken> names_;
};
// Of locators of one name alone.
class HdDataSourceLocatorSet : public std::vector<HdDataSourceLocator> {
  public:
    using std::vector<HdDataSourceLocator>::vector;
    void insert(const HdDataSourceLocator& locator) { push_back(locator); }
    bool Intersects(const HdDataSourceLocatorSet& others) const {
        for (const HdDataSourceLocator& each : *this)
            for (const HdDataSourceLocator& other : others)
                if (each.GetFirstElement() == other.GetFirstElement()) return true;
        return false;
    }
};

#define HD_DECLARE_DATASOURCE_ABSTRACT(type)                          \
    using Handle = std::shared_ptr<type>;                             \
    static Handle Cast(const std::shared_ptr<HdDataSourceBase>& of) { \
        return std::dynamic_pointer_cast<type>(of);                   \
    }
#define HD_DECLARE_DATASOURCE(type)                                     \
    HD_DECLARE_DATASOURCE_ABSTRACT(type)                                \
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
    HD_DECLARE_DATASOURCE_ABSTRACT(HdContainerDataSource)
    virtual HdDataSourceBaseHandle Get(const TfToken& name) = 0;
    static HdDataSourceBaseHandle Get(const Handle& container, const HdDataSourceLocator& locator) {
        HdDataSourceBaseHandle found = container;
        for (std::size_t i = 0; i < locator.GetElementCount(); ++i) {
            const Handle parent = Cast(found);
            found = parent ? parent->Get(locator.GetElement(i)) : nullptr;
        }
        return found;
    }
};
using HdContainerDataSourceHandle = HdContainerDataSource::Handle;

class HdSampledDataSource : public HdDataSourceBase {
  public:
    HD_DECLARE_DATASOURCE_ABSTRACT(HdSampledDataSource)
    using Time = float;
    virtual VtValue GetValue(Time time) = 0;
    virtual bool GetContributingSampleTimesForInterval(Time open, Time close, std::vector<Time>* times) = 0;
};
using HdSampledDataSourceHandle = HdSampledDataSource::Handle;

template <class T>
class HdTypedSampledDataSource : public HdSampledDataSource {
  public:
    HD_DECLARE_DATASOURCE_ABSTRACT(HdTypedSampledDataSource<T>)
    virtual T GetTypedValue(Time time) = 0;
};
using HdMatrixDataSource = HdTypedSampledDataSource<GfMatrix4d>;
using HdMatrixDataSourceHandle = HdMatrixDataSource::Handle;

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

// The first one's word counts.
class HdOverlayContainerDataSource : public HdContainerDataSource {
  public:
    HD_DECLARE_DATASOURCE(HdOverlayContainerDataSource)
    HdOverlayContainerDataSource(HdContainerDataSourceHandle first, HdContainerDataSourceHandle second)
        : first_(std::move(first)), second_(std::move(second)) {}
    HdDataSourceBaseHandle Get(const TfToken& name) override {
        const HdDataSourceBaseHandle first = first_->Get(name), second = second_->Get(name);
        const HdContainerDataSourceHandle over = HdContainerDataSource::Cast(first),
                                          under = HdContainerDataSource::Cast(second);
        if (over && under) return New(over, under);
        return first ? first : second;
    }

  private:
    HdContainerDataSourceHandle first_, second_;
};

// ---- Tokens and schemas

#define TOKENS_OF_STAND_IN(name, ...)                                                \
    inline const struct name##OfStandIn { TfToken __VA_ARGS__; } name##_of_stand_in; \
    inline const auto* const name = &name##_of_stand_in;
TOKENS_OF_STAND_IN(HdPrimTypeTokens, mesh{"mesh"})
TOKENS_OF_STAND_IN(HdMeshSchemaTokens, mesh{"mesh"}, topology{"topology"},
                   subdivisionScheme{"subdivisionScheme"})
TOKENS_OF_STAND_IN(HdMeshTopologySchemaTokens, faceVertexCounts{"faceVertexCounts"},
                   faceVertexIndices{"faceVertexIndices"})
TOKENS_OF_STAND_IN(HdXformSchemaTokens, xform{"xform"}, matrix{"matrix"}, resetXformStack{"resetXformStack"})
TOKENS_OF_STAND_IN(HdPrimvarsSchemaTokens, primvars{"primvars"}, points{"points"}, normals{"normals"})
TOKENS_OF_STAND_IN(HdPrimvarSchemaTokens, primvarValue{"primvarValue"}, interpolation{"interpolation"},
                   role{"role"}, vertex{"vertex"}, point{"point"}, normal{"normal"})
TOKENS_OF_STAND_IN(HdMaterialBindingsSchemaTokens, materialBindings{"materialBindings"})
TOKENS_OF_STAND_IN(HdPurposeSchemaTokens, purpose{"purpose"})
TOKENS_OF_STAND_IN(HdVisibilitySchemaTokens, visibility{"visibility"})
TOKENS_OF_STAND_IN(PxOsdOpenSubdivTokens, none{"none"})

#define SCHEMA_OF_STAND_IN(name, word)                               \
    struct name {                                                    \
        static const HdDataSourceLocator& GetDefaultLocator() {      \
            static const HdDataSourceLocator locator{TfToken(word)}; \
            return locator;                                          \
        }                                                            \
    };
SCHEMA_OF_STAND_IN(HdPrimvarsSchema, "primvars")
SCHEMA_OF_STAND_IN(HdMeshSchema, "mesh")
SCHEMA_OF_STAND_IN(HdXformSchema, "xform")
SCHEMA_OF_STAND_IN(HdMaterialBindingsSchema, "materialBindings")
SCHEMA_OF_STAND_IN(HdPurposeSchema, "purpose")
SCHEMA_OF_STAND_IN(HdVisibilitySchema, "visibility")

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

class HfPluginBase {
  public:
    virtual ~HfPluginBase() = default;

  protected:
    HfPluginBase() = default;
};
class HdGpGenerativeProceduralPlugin : public HfPluginBase {
  public:
    virtual HdGpGenerativeProcedural* Construct(const SdfPath& path) = 0;

  protected:
    HdGpGenerativeProceduralPlugin() = default;
    ~HdGpGenerativeProceduralPlugin() override = default;
};

// What the host has been told, and what it does when it is told something more.
struct HydraStandIn {
    std::vector<std::shared_ptr<HdGpGenerativeProceduralPlugin>> plugins;
    std::mutex lock;
    std::vector<std::string> log;
    std::function<void()> told;
};
inline HydraStandIn& hydra_stand_in() {
    static HydraStandIn host;
    return host;
}

class HdGpGenerativeProceduralPluginRegistry {
  public:
    template <class Plugin>
    static void Define() {
        hydra_stand_in().plugins.push_back(std::make_shared<Plugin>());
    }
};

inline void hydra_stand_in_log(const char* format, ...) {
    char text[4096];
    va_list words;
    va_start(words, format);
    std::vsnprintf(text, sizeof text, format, words);
    va_end(words);
    {
        const std::lock_guard<std::mutex> lock(hydra_stand_in().lock);
        hydra_stand_in().log.emplace_back(text);
    }
    if (hydra_stand_in().told) hydra_stand_in().told();
}

}  // namespace pxr

#define TF_WARN pxr::hydra_stand_in_log
#define TF_RUNTIME_ERROR pxr::hydra_stand_in_log
// Runs when the program is loaded.
#define TF_REGISTRY_FUNCTION(type)                                                  \
    static void register_for_stand_in();                                            \
    static const bool is_registered_for_stand_in = (register_for_stand_in(), true); \
    static void register_for_stand_in()
