// examples/renderers in hosts of our own behind stand-ins for the renderers' headers: what each procedural hands over is what
// pelagic_expand() says, mistakes are messages, work can be stopped, and nothing is kept. Whether the real hosts take it isn't asked here.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "examples/renderers/sea_mesh.h"
#include "tests/examples/stand_ins/arnold.h"
#include "tests/examples/stand_ins/hydra.h"
#include "tests/examples/stand_ins/renderman.h"

extern "C" {
bool NodeLoader(int i, AtNodeLib* node);
void pelagic_arnold_stop(int stopped);
void pelagic_renderman_stop(int stopped);
RtVoid Subdivide2(RtContextHandle, RtFloat, RtInt, RtToken const[], RtPointer const[]);
}

namespace {

using Floats = std::vector<float>;

// What a host has been handed.
struct Given {
    std::vector<Floats> positions;  // a key of motion each
    std::vector<double> times;      // of them
    Floats normal, slope_variance, coverage;
    std::vector<int> counts, corner;
    std::array<double, 3> origin_m{};
    bool is_there() const { return !positions.empty(); }
};

std::vector<int> ints(const std::vector<std::uint32_t>& values) {
    return {values.begin(), values.end()};
}

// ---- Arnold

class Arnold {
  public:
    static Given give(const SeaParameters& asked) { return give_at(asked, true); }
    static Given give_at(const SeaParameters& asked, bool has_motion) {
        AtNodeLib library{};
        EXPECT_TRUE(NodeLoader(0, &library));
        EXPECT_FALSE(NodeLoader(1, &library));
        EXPECT_STREQ(library.name, "pelagic_sea");
        AtUniverse universe;
        AtNode node;
        node.universe = &universe;
        AtList list{&node};
        AtNodeEntry entry;
        library.methods->Parameters(&list, &entry);
        node.strings.at("shot") = asked.shot;
        node.numbers.at("frame") = asked.frame;
        node.numbers.at("finest_cell") = asked.finest_cell_m;
        node.numbers.at("threads") = asked.threads;
        if (has_motion) {  // a shape's own
            node.numbers["motion_start"] = asked.shutter_open;
            node.numbers["motion_end"] = asked.shutter_close;
        } else {
            node.entry.parameters.clear();
        }
        void* data = nullptr;
        const int is_ready = library.methods->Init(&node, &data);
        Given given;
        EXPECT_EQ(library.methods->NumNodes(&node, data), is_ready);
        EXPECT_EQ(library.methods->GetNode(&node, data, 1), nullptr);
        if (const AtNode* mesh = is_ready ? library.methods->GetNode(&node, data, 0) : nullptr) {
            EXPECT_EQ(mesh->type, "polymesh");
            EXPECT_EQ(mesh->parent, &node);
            EXPECT_EQ(mesh->universe, &universe);
            EXPECT_EQ(mesh->declared.at("slopeVariance"), "varying VECTOR");
            EXPECT_EQ(mesh->declared.at("whitecapCoverage"), "varying FLOAT");
            const AtArray &points = *mesh->arrays.at("vlist"), &normals = *mesh->arrays.at("nlist");
            EXPECT_EQ(points.keys, normals.keys);
            const auto keys = static_cast<std::size_t>(points.keys), size = points.floats.size() / keys;
            for (std::size_t key = 0; key < keys; ++key) {
                given.positions.emplace_back(points.floats.begin() + key * size,
                                             points.floats.begin() + (key + 1) * size);
                given.times.push_back(mesh->numbers.at(key == 0 ? "motion_start" : "motion_end"));
                const Floats normal(normals.floats.begin() + key * size,
                                    normals.floats.begin() + (key + 1) * size);
                EXPECT_TRUE(key == 0 || normal == given.normal);
                given.normal = normal;
            }
            given.slope_variance = mesh->arrays.at("slopeVariance")->floats;
            given.coverage = mesh->arrays.at("whitecapCoverage")->floats;
            given.counts = ints(mesh->arrays.at("nsides")->uints);
            given.corner = ints(mesh->arrays.at("vidxs")->uints);
            EXPECT_EQ(given.corner, ints(mesh->arrays.at("nidxs")->uints));
            for (std::size_t axis = 0; axis < 3; ++axis)
                given.origin_m[axis] = static_cast<double>(mesh->matrices.at("matrix").data[3][axis]);
        }
        EXPECT_TRUE(library.methods->Cleanup(&node, data));
        arnold_stand_in().nodes.clear();
        return given;
    }
    static std::vector<std::string> log() { return std::exchange(arnold_stand_in().log, {}); }
    static void stop(bool stopped) { pelagic_arnold_stop(stopped); }
};

// ---- RenderMan

class RenderMan {
  public:
    static Given give(const SeaParameters& asked) {
        RenderManStandIn& host = renderman_stand_in();
        RtString shot = asked.shot.c_str();
        auto frame = static_cast<RtFloat>(asked.frame),
             finest_cell = static_cast<RtFloat>(asked.finest_cell_m);
        RtInt threads = asked.threads;
        RtFloat shutter[] = {static_cast<RtFloat>(asked.shutter_open),
                             static_cast<RtFloat>(asked.shutter_close)};
        // With their types and without.
        RtToken tokens[] = {"string shot", "frame", "float finestcell", "int threads", "float[2] shutter"};
        RtPointer values[] = {&shot, &frame, &finest_cell, &threads, shutter};
        Subdivide2(nullptr, 1.0f, 5, tokens, values);
        Given given;
        const std::vector<std::string> all = {"AttributeBegin", "ConcatTransform", "MotionBegin",
                                              "PointsPolygons", "PointsPolygons",  "MotionEnd",
                                              "AttributeEnd"},
                                       still = {"AttributeBegin", "ConcatTransform", "PointsPolygons",
                                                "AttributeEnd"};
        if (!host.calls.empty()) {
            EXPECT_EQ(host.calls, host.polygons.size() == 2 ? all : still);
        }
        for (const RenderManStandIn::Polygons& mesh : host.polygons) {
            given.positions.push_back(mesh.values.at("P"));
            given.normal = mesh.values.at("N");
            given.slope_variance = mesh.values.at("vertex float[3] slopeVariance");
            given.coverage = mesh.values.at("vertex float whitecapCoverage");
            given.counts = mesh.corners;
            given.corner = mesh.indices;
        }
        given.times.assign(host.times.begin(), host.times.end());
        std::copy_n(host.translation.begin(), 3, given.origin_m.begin());
        const std::vector<std::string> log = host.log;
        host = {};
        host.log = log;
        return given;
    }
    static std::vector<std::string> log() { return std::exchange(renderman_stand_in().log, {}); }
    static void stop(bool stopped) { pelagic_renderman_stop(stopped); }
};

// ---- Hydra

using namespace pxr;

template <class T>
HdDataSourceBaseHandle source_of(const T& value) {
    return HdRetainedTypedSampledDataSource<T>::New(value);
}

class HydraScene final : public HdSceneIndexBase {
  public:
    explicit HydraScene(const SeaParameters& asked) : threads(asked.threads), asked_(asked) {}
    HdSceneIndexPrim GetPrim(const SdfPath& path) const override {
        EXPECT_EQ(path.GetString(), "/Sea");
        const auto primvar = [](const HdDataSourceBaseHandle& value) {
            return HdRetainedContainerDataSource::New(TfToken("primvarValue"), value);
        };
        // Some as artists author them: an asset, an integer, a float.
        const auto primvars = HdRetainedContainerDataSource::New(
            TfToken("shot"), primvar(source_of(SdfAssetPath("unresolved.toml", asked_.shot))),
            TfToken("frame"), primvar(source_of(asked_.frame)), TfToken("finestCell"),
            primvar(source_of(static_cast<float>(asked_.finest_cell_m))), TfToken("threads"),
            primvar(source_of(threads)), TfToken("shutterOpen"), primvar(source_of(asked_.shutter_open)),
            TfToken("shutterClose"), primvar(source_of(asked_.shutter_close)));
        const auto named = [](const char* name, const HdDataSourceBaseHandle& value) {
            return HdRetainedContainerDataSource::New(TfToken(name), value);
        };
        return {TfToken("hydraGenerativeProcedural"),
                HdRetainedContainerDataSource::New(
                    TfToken("primvars"), primvars, TfToken("xform"), named("matrix", source_of(matrix)),
                    TfToken("materialBindings"), named("", named("path", source_of(material))),
                    TfToken("visibility"), named("visibility", source_of(false)), TfToken("purpose"),
                    named("purpose", source_of(TfToken("render"))))};
    }

    VtValue threads;
    GfMatrix4d matrix{1.0};
    SdfPath material{"/Water"};

  private:
    SeaParameters asked_;
};

class Hydra {
  public:
    explicit Hydra(bool is_async = false) {
        EXPECT_EQ(hydra_stand_in().plugins.size(), 1u);
        procedural_.reset(hydra_stand_in().plugins.at(0)->Construct(SdfPath("/Sea")));
        EXPECT_EQ(procedural_->AsyncBegin(is_async), is_async);
    }

    void ask(const SeaParameters& asked) { ask(std::make_shared<HydraScene>(asked), asked); }
    // With `changes` of the prim; hosts may ask for no list of what is dirty.
    void ask(const std::shared_ptr<HydraScene>& scene, const SeaParameters& asked,
             const HdDataSourceLocatorSet& changes = {}, bool has_list = true) {
        asked_ = asked;
        scene_ = scene;
        HdGpGenerativeProcedural::DependencyMap changed;
        if (!changes.empty()) changed[SdfPath("/Sea")] = changes;
        EXPECT_EQ(
            names_of(procedural_->UpdateDependencies(scene).at(SdfPath("/Sea"))),
            (std::vector<std::string>{"materialBindings", "purpose", "visibility", "xform", "primvars"}));
        dirtied.clear();
        children = procedural_->Update(scene, children, changed, has_list ? &dirtied : nullptr);
    }
    static std::vector<std::string> names_of(const HdDataSourceLocatorSet& locators) {
        std::vector<std::string> names;
        for (const HdDataSourceLocator& each : locators) names.push_back(each.GetFirstElement().GetString());
        return names;
    }
    HdGpGenerativeProcedural::AsyncState poll() {
        dirtied.clear();
        return procedural_->AsyncUpdate(children, &children, &dirtied);
    }
    void wait() {
        while (poll() == HdGpGenerativeProcedural::Continuing) std::this_thread::yield();
    }
    HdContainerDataSourceHandle prim() const {
        EXPECT_FALSE(procedural_->GetChildPrim(scene_, SdfPath("/Sea/other")).dataSource);
        return procedural_->GetChildPrim(scene_, SdfPath("/Sea/sea")).dataSource;
    }
    // Another one is another mesh.
    HdDataSourceBaseHandle mesh() const { return prim()->Get(TfToken("mesh")); }
    template <class Source>
    static std::shared_ptr<Source> at(const HdContainerDataSourceHandle& prim,
                                      const std::vector<const char*>& names) {
        HdDataSourceBaseHandle source = prim;
        for (const char* name : names) {
            const auto container = std::dynamic_pointer_cast<HdContainerDataSource>(source);
            source = container ? container->Get(TfToken(name)) : nullptr;
        }
        return std::dynamic_pointer_cast<Source>(source);
    }

    Given given() const {
        Given given;
        if (children.empty()) return given;
        EXPECT_EQ(children.size(), 1u);
        EXPECT_EQ(children.at(SdfPath("/Sea/sea")).GetString(), "mesh");
        const HdContainerDataSourceHandle made = prim();
        const auto points = at<HdSampledDataSource>(made, {"primvars", "points", "primvarValue"});
        const auto open = static_cast<float>(asked_.shutter_open),
                   close = static_cast<float>(asked_.shutter_close);
        std::vector<float> times;
        if (!points->GetContributingSampleTimesForInterval(open, close, &times)) times = {open};
        for (const float time : times) {
            given.times.push_back(static_cast<double>(time));
            given.positions.push_back(floats(points->GetValue(time)));
        }
        const auto value = [&](const char* name) {
            return at<HdSampledDataSource>(made, {"primvars", name, "primvarValue"})->GetValue(0.0f);
        };
        for (const char* name : {"points", "normals", "slopeVariance", "whitecapCoverage"})
            EXPECT_EQ(token(made, {"primvars", name, "interpolation"}), "vertex");
        EXPECT_EQ(token(made, {"primvars", "points", "role"}), "point");
        EXPECT_EQ(token(made, {"mesh", "subdivisionScheme"}), "none");
        given.normal = floats(value("normals"));
        given.slope_variance = floats(value("slopeVariance"));
        given.coverage = value("whitecapCoverage").UncheckedGet<VtFloatArray>();
        given.counts = indices(made, "faceVertexCounts");
        given.corner = indices(made, "faceVertexIndices");
        const GfMatrix4d matrix =
            at<HdTypedSampledDataSource<GfMatrix4d>>(made, {"xform", "matrix"})->GetTypedValue(0.0f);
        for (std::size_t axis = 0; axis < 3; ++axis) given.origin_m[axis] = matrix[3][axis];
        return given;
    }

    static Given give(const SeaParameters& asked) {
        Hydra hydra;
        hydra.ask(asked);
        return hydra.given();
    }
    static std::vector<std::string> log() {
        const std::lock_guard<std::mutex> lock(hydra_stand_in().lock);
        return std::exchange(hydra_stand_in().log, {});
    }

    HdGpGenerativeProcedural::ChildPrimTypeMap children;
    HdSceneIndexObserver::DirtiedPrimEntries dirtied;

  private:
    static std::string token(const HdContainerDataSourceHandle& prim, const std::vector<const char*>& names) {
        return at<HdTypedSampledDataSource<TfToken>>(prim, names)->GetTypedValue(0.0f).GetString();
    }
    static std::vector<int> indices(const HdContainerDataSourceHandle& prim, const char* name) {
        return at<HdTypedSampledDataSource<VtIntArray>>(prim, {"mesh", "topology", name})
            ->GetTypedValue(0.0f);
    }
    static Floats floats(const VtValue& value) {
        Floats all;
        for (const GfVec3f& each : value.UncheckedGet<VtVec3fArray>())
            for (std::size_t axis = 0; axis < 3; ++axis) all.push_back(each[axis]);
        return all;
    }

    std::unique_ptr<HdGpGenerativeProcedural> procedural_;
    std::shared_ptr<HydraScene> scene_;
    SeaParameters asked_;
};

// ---- The tests

struct Host {
    const char* name;
    Given (*give)(const SeaParameters&);
    std::vector<std::string> (*log)();
};
std::ostream& operator<<(std::ostream& out, const Host& host) {
    return out << host.name;
}
std::string name_of(const testing::TestParamInfo<Host>& host) {
    return host.param.name;
}
constexpr Host kHosts[] = {{"Arnold", Arnold::give, Arnold::log},
                           {"RenderMan", RenderMan::give, RenderMan::log},
                           {"Hydra", Hydra::give, Hydra::log}};

// A small sea a long way from the world's origin, as exact in single precision as matrices need it, in slow motion.
constexpr const char* kShot = R"([shot]
frames = [1, 24]
fps = 25
time_scale = 0.5
[sea]
wind_speed_mps = 14.0
[waves]
cascades = [ { size_m = 400.0, resolution = 256 }, { size_m = 37.0, resolution = 128 } ]
[effects]
foam_decay_s = 0.0
[camera]
resolution = [96, 54]
position_m = [8192.0, -4096.0, 6.0]
look_at_m = [8292.0, -4096.0, 0.0]
)";

std::string text_with(const std::string& now, const std::string& instead) {
    std::string text = kShot;
    return text.replace(text.find(now), now.size(), instead);
}

class SeaMeshes : public testing::Test {
  protected:
    SeaMeshes() {
        std::filesystem::create_directories(folder_);
        for (const auto& host : kHosts) host.log();
    }
    ~SeaMeshes() override { std::filesystem::remove_all(folder_); }

    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return (folder_ / name).string();
    }
    SeaParameters asked() const {
        SeaParameters asked;
        asked.shot = write("shot.toml", kShot);
        asked.frame = 12.0;
        asked.threads = 2;
        asked.finest_cell_m = 0.5;
        asked.shutter_open = -0.125;
        asked.shutter_close = 0.375;
        return asked;
    }

    const std::filesystem::path folder_ =
        std::filesystem::path(testing::TempDir()) / ("renderers." + std::to_string(getpid()));
};
class Renderers : public SeaMeshes, public testing::WithParamInterface<Host> {};

// By the C interface, as a program asks it that shares nothing with the procedurals.
struct Expected {
    Floats position, normal, velocity, slope_variance, coverage;
    std::vector<std::uint32_t> corner;
    pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
};
Expected expand(const SeaParameters& asked) {
    Expected expected;
    pelagic_error error;
    const auto check = [&](pelagic_status status) { ASSERT_EQ(status, PELAGIC_OK) << error.message; };
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.path = asked.shot.c_str();
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.finest_cell_m = asked.finest_cell_m;
    pelagic_sea* sea = nullptr;
    check(pelagic_open(&source, &options, &sea, &error));
    double open_s = 0.0, close_s = 0.0;
    check(pelagic_time_of_frame(sea, asked.frame + asked.shutter_open, &open_s, &error));
    check(pelagic_time_of_frame(sea, asked.frame + asked.shutter_close, &close_s, &error));
    pelagic_frame* frame = nullptr;
    check(pelagic_frame_create(sea, open_s, close_s, &frame, &error));
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    check(pelagic_shot_camera(sea, asked.frame, &camera, &error));
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    check(pelagic_expand_size(frame, &camera, nullptr, &size, &error));
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    const auto room = [](auto& of, std::size_t count) {
        of.resize(count);
        return of.data();
    };
    values.position_m = room(expected.position, 3 * size.points);
    values.normal = room(expected.normal, 3 * size.points);
    values.velocity_mps = room(expected.velocity, 3 * size.points);
    values.slope_variance = room(expected.slope_variance, 3 * size.points);
    values.coverage = room(expected.coverage, size.points);
    expected.mesh.points = size.points;
    expected.mesh.corners = size.corners;
    expected.mesh.corner = room(expected.corner, size.corners);
    expected.mesh.values = &values;
    check(pelagic_expand(frame, &camera, nullptr, &expected.mesh, &error));
    pelagic_frame_release(frame);
    pelagic_close(sea);
    return expected;
}

void expect_same(const Given& given, const Expected& expected) {
    ASSERT_TRUE(given.is_there());
    EXPECT_EQ(given.corner, ints(expected.corner));
    EXPECT_EQ(given.counts, std::vector<int>(expected.corner.size() / 4, 4));
    EXPECT_EQ(given.normal, expected.normal);
    EXPECT_EQ(given.slope_variance, expected.slope_variance);
    EXPECT_EQ(given.coverage, expected.coverage);
    for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(given.origin_m[axis], expected.mesh.origin_m[axis]) << axis;
}

TEST_P(Renderers, GetTheMeshOfExpand) {
    const SeaParameters parameters = asked();
    const Expected expected = expand(parameters);
    const Given given = GetParam().give(parameters);
    EXPECT_TRUE(GetParam().log().empty());
    expect_same(given, expected);
    EXPECT_GT(given.counts.size(), 1000u);
    EXPECT_GT(given.origin_m[0], 8000.0);  // the origin matters
    EXPECT_GT(*std::max_element(given.slope_variance.begin(), given.slope_variance.end()), 0.0f);
    // A key at either end of the shutter, away from its middle along the velocity; seconds of the sea, of which half a one is a second
    // on the screen.
    ASSERT_EQ(given.times, (std::vector<double>{parameters.shutter_open, parameters.shutter_close}));
    ASSERT_EQ(given.positions.size(), 2u);
    float farthest_m = 0.0f;
    for (std::size_t key = 0; key < 2; ++key) {
        ASSERT_EQ(given.positions[key].size(), expected.position.size());
        const float seconds = (key == 0 ? -0.25f : 0.25f) * 0.5f / 25.0f;
        for (std::size_t i = 0; i < expected.position.size(); ++i) {
            const float wanted_m = expected.position[i] + seconds * expected.velocity[i];
            // Three roundings of a float.
            ASSERT_NEAR(given.positions[key][i], wanted_m, 4e-7f * (std::abs(wanted_m) + 1.0f))
                << key << ' ' << i;
            farthest_m = std::max(farthest_m, std::abs(seconds * expected.velocity[i]));
        }
    }
    EXPECT_GT(farthest_m, 0.001f);
}

TEST_P(Renderers, HaveOneKeyWhereTheShutterIsAMoment) {
    SeaParameters parameters = asked();
    parameters.shutter_open = parameters.shutter_close = 0.0;
    const Expected expected = expand(parameters);
    const Given given = GetParam().give(parameters);
    expect_same(given, expected);
    ASSERT_EQ(given.positions.size(), 1u);
    EXPECT_EQ(given.positions[0], expected.position);
}

TEST_P(Renderers, TellWhatIsWrong) {
    SeaParameters parameters = asked();
    parameters.shot = write("wrong.toml", "[sea]\nwind_speed_mps = -3.0\n");
    EXPECT_FALSE(GetParam().give(parameters).is_there());
    std::vector<std::string> log = GetParam().log();
    ASSERT_EQ(log.size(), 1u);
    EXPECT_NE(log[0].find("wrong.toml:2"), std::string::npos) << log[0];
    EXPECT_NE(log[0].find("wind_speed_mps"), std::string::npos) << log[0];

    parameters.shot = (folder_ / "missing.toml").string();
    EXPECT_FALSE(GetParam().give(parameters).is_there());
    log = GetParam().log();
    ASSERT_EQ(log.size(), 1u);
    EXPECT_NE(log[0].find("missing.toml"), std::string::npos) << log[0];

    parameters = asked();
    parameters.shutter_close = 100.0;  // longer than a second
    EXPECT_FALSE(GetParam().give(parameters).is_there());
    log = GetParam().log();
    ASSERT_EQ(log.size(), 1u);
    EXPECT_NE(log[0].find("shutter"), std::string::npos) << log[0];
    // And what is right afterwards is.
    EXPECT_TRUE(GetParam().give(asked()).is_there());
    EXPECT_TRUE(GetParam().log().empty());
}

// What the allocator keeps for itself is less than a mesh.
TEST_P(Renderers, GiveTheirMemoryBack) {
    SeaParameters parameters = asked();
    const auto in_use = [] {
        const struct mallinfo2 info = mallinfo2();
        return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
    };
    std::size_t floats = 0;
    std::vector<double> after;
    for (int round = 0; round < 4; ++round) {
        {
            const Given given = GetParam().give(parameters);
            floats = given.normal.size();
        }
        after.push_back(in_use());
    }
    EXPECT_LT(after[3] - after[1], sizeof(float) * static_cast<double>(floats));
}

INSTANTIATE_TEST_SUITE_P(Each, Renderers, testing::ValuesIn(kHosts), name_of);

class StoppedRenderers : public Renderers {};

// Neither of the two tells a procedural that it is to stop: the application does.
TEST_P(StoppedRenderers, GiveNothingUntilTheyMayGoOn) {
    void (*const stop)(bool) = std::string(GetParam().name) == "Arnold" ? Arnold::stop : RenderMan::stop;
    stop(true);
    EXPECT_FALSE(GetParam().give(asked()).is_there());
    EXPECT_TRUE(GetParam().log().empty());
    stop(false);
    EXPECT_TRUE(GetParam().give(asked()).is_there());
}

INSTANTIATE_TEST_SUITE_P(Each, StoppedRenderers, testing::ValuesIn(kHosts, kHosts + 2), name_of);

// At each stage: while the sea is built, and when a frame of it is set.
TEST_F(SeaMeshes, AreStoppedFromAnyThread) {
    SeaStop stop;
    SeaSource source(stop);
    const SeaParameters parameters = asked();
    EXPECT_FALSE(source.mesh(parameters).position_m.empty());
    std::thread([&] { stop.set(true); }).join();
    EXPECT_THROW(source.mesh(parameters), SeaStopped);
    SeaParameters other = parameters;
    other.finest_cell_m = 0.6;
    EXPECT_THROW(source.mesh(other), SeaStopped);
    stop.set(false);
    EXPECT_FALSE(source.mesh(other).position_m.empty());
    EXPECT_EQ(source.mesh(parameters).position_m, SeaSource(stop).mesh(parameters).position_m);
}

TEST_F(SeaMeshes, PassNotesOn) {
    SeaStop stop;
    SeaParameters parameters = asked();
    parameters.shot = write("note.toml", text_with("400.0", "120.0"));  // holds few of its waves
    std::vector<std::string> notes;
    SeaSource(stop).mesh(parameters, [&](const char* sentence) { notes.emplace_back(sentence); });
    EXPECT_FALSE(notes.empty());
}

// As of a shape that knows no motion: that which the other hosts have where nobody says any.
TEST_F(SeaMeshes, AreMadeForNodesOfArnoldWithoutMotion) {
    SeaParameters parameters = asked();
    const SeaParameters unset;
    parameters.shutter_open = unset.shutter_open;
    parameters.shutter_close = unset.shutter_close;
    const Given given = Arnold::give_at(parameters, false);
    expect_same(given, expand(parameters));
    EXPECT_EQ(given.positions.size(), 2u);
}

class HydraSea : public SeaMeshes {
  protected:
    ~HydraSea() override { hydra_stand_in().told = nullptr; }
};

TEST_F(HydraSea, WorksWhereSomethingHasChangedAlone) {
    Hydra hydra;
    SeaParameters parameters = asked();
    hydra.ask(parameters);
    EXPECT_TRUE(hydra.dirtied.empty());  // it is new
    const HdDataSourceBaseHandle first = hydra.mesh();
    hydra.ask(parameters);
    EXPECT_EQ(hydra.mesh(), first);
    EXPECT_TRUE(hydra.dirtied.empty());
    parameters.frame = 13.0;
    hydra.ask(parameters);
    EXPECT_NE(hydra.mesh(), first);
    ASSERT_EQ(hydra.dirtied.size(), 1u);
    EXPECT_EQ(hydra.dirtied[0].primPath.GetString(), "/Sea/sea");
    EXPECT_EQ(Hydra::names_of(hydra.dirtied[0].dirtyLocators),
              (std::vector<std::string>{"mesh", "primvars", "xform"}));
    // A frame after another is that frame alone.
    expect_same(hydra.given(), expand(parameters));
    // A host may ask for no list.
    parameters.frame = 14.0;
    hydra.ask(std::make_shared<HydraScene>(parameters), parameters, {HdXformSchema::GetDefaultLocator()},
              false);
    expect_same(hydra.given(), expand(parameters));
    // What fails takes the mesh away.
    parameters.shot = "";
    hydra.ask(std::make_shared<HydraScene>(parameters), parameters, {HdXformSchema::GetDefaultLocator()});
    EXPECT_TRUE(hydra.children.empty() && hydra.dirtied.empty());
    EXPECT_EQ(Hydra::log().size(), 1u);
}

TEST_F(HydraSea, IsMovedBoundShownAndHiddenAsItsPrim) {
    Hydra hydra;
    const SeaParameters parameters = asked();
    const auto scene = std::make_shared<HydraScene>(parameters);
    hydra.ask(scene, parameters);
    const HdDataSourceBaseHandle first = hydra.mesh();
    const Expected expected = expand(parameters);
    // Twice as large and away: of powers of two, which are exact.
    for (std::size_t axis = 0; axis < 3; ++axis) scene->matrix[axis][axis] = 2.0;
    scene->matrix[3][0] = 64.0;
    scene->material = SdfPath("/Foam");
    hydra.ask(scene, parameters, {HdXformSchema::GetDefaultLocator()});
    ASSERT_EQ(hydra.dirtied.size(), 1u);
    EXPECT_EQ(hydra.dirtied[0].primPath.GetString(), "/Sea/sea");
    EXPECT_EQ(Hydra::names_of(hydra.dirtied[0].dirtyLocators),
              (std::vector<std::string>{"materialBindings", "purpose", "visibility", "xform"}));
    EXPECT_EQ(hydra.mesh(), first);
    const HdContainerDataSourceHandle prim = hydra.prim();
    const auto value = [&](auto type, const std::vector<const char*>& names) {
        const auto source = Hydra::at<HdTypedSampledDataSource<decltype(type)>>(prim, names);
        EXPECT_TRUE(source) << names[0];
        return source ? source->GetTypedValue(0.0f) : type;
    };
    const GfMatrix4d matrix = value(GfMatrix4d(0.0), {"xform", "matrix"});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(matrix[axis][axis], 2.0);
        EXPECT_EQ(matrix[3][axis], 2.0 * expected.mesh.origin_m[axis] + (axis == 0 ? 64.0 : 0.0));
    }
    EXPECT_TRUE(value(false, {"xform", "resetXformStack"}));
    EXPECT_EQ(value(SdfPath(), {"materialBindings", "", "path"}).GetString(), "/Foam");
    EXPECT_FALSE(value(true, {"visibility", "visibility"}));
    EXPECT_EQ(value(TfToken(), {"purpose", "purpose"}).GetString(), "render");
    EXPECT_FALSE(Hydra::at<HdDataSourceBase>(prim, {"primvars", "shot"}));
    // What changes of the primvars alone changes nothing of these.
    hydra.ask(scene, parameters, {HdPrimvarsSchema::GetDefaultLocator()});
    EXPECT_TRUE(hydra.dirtied.empty());
}

TEST_F(HydraSea, IsOfTheShotFileAsItIsNow) {
    Hydra hydra;
    SeaParameters parameters = asked();
    hydra.ask(parameters);
    const std::filesystem::path shot = parameters.shot;
    const auto written = std::filesystem::last_write_time(shot);
    write("shot.toml", text_with("14.0", "20.0"));
    std::filesystem::last_write_time(shot, written + std::chrono::seconds(1));
    hydra.ask(parameters);
    expect_same(hydra.given(), expand(parameters));
    // What has failed is tried again, whatever it was that has been mended.
    write("shot.toml", text_with("14.0", "-3.0"));
    std::filesystem::last_write_time(shot, written);
    hydra.ask(parameters);
    EXPECT_TRUE(hydra.children.empty());
    EXPECT_EQ(Hydra::log().size(), 1u);
    write("shot.toml", kShot);
    std::filesystem::last_write_time(shot, written);
    hydra.ask(parameters);
    expect_same(hydra.given(), expand(parameters));
    EXPECT_TRUE(Hydra::log().empty());
}

TEST_F(HydraSea, RefusesNumbersThatAreNone) {
    SeaParameters parameters = asked();
    const auto scene = std::make_shared<HydraScene>(parameters);
    scene->threads = VtValue(1e12);  // all
    Hydra hydra(true);
    hydra.ask(scene, parameters);
    hydra.wait();
    EXPECT_FALSE(hydra.children.empty());
    EXPECT_TRUE(Hydra::log().empty());
    parameters.frame = std::nan("");
    for (int times = 0; times < 2; ++times) {
        hydra.ask(parameters);
        EXPECT_TRUE(hydra.children.empty());
        const std::vector<std::string> log = Hydra::log();
        ASSERT_EQ(log.size(), 1u);
        EXPECT_NE(log[0].find("primvars:frame"), std::string::npos) << log[0];
        EXPECT_EQ(hydra.poll(), HdGpGenerativeProcedural::Finished);  // no work has begun
    }
    scene->threads = VtValue(-std::numeric_limits<float>::infinity());
    hydra.ask(scene, parameters = asked());
    EXPECT_TRUE(hydra.children.empty());
    ASSERT_EQ(Hydra::log().size(), 1u);
}

// Who asks while the next one is made and the host waits for it gets the last one, not the next. The ten seconds are for a host that makes
// them wait.
TEST_F(HydraSea, IsTheLastOneForWhoAsksMeanwhile) {
    Hydra hydra;
    SeaParameters parameters = asked();
    hydra.ask(parameters);
    const HdDataSourceBaseHandle first = hydra.mesh();
    std::future<HdDataSourceBaseHandle> meanwhile;
    hydra_stand_in().told = [&] {
        meanwhile = std::async(std::launch::async, [&] { return hydra.mesh(); });
        meanwhile.wait_for(std::chrono::seconds(10));
    };
    parameters.shot = write("note.toml", text_with("400.0", "120.0"));
    hydra.ask(parameters);
    ASSERT_TRUE(meanwhile.valid());
    EXPECT_EQ(meanwhile.get(), first);
    EXPECT_NE(hydra.mesh(), first);
    EXPECT_FALSE(Hydra::log().empty());
}

TEST_F(HydraSea, ShowsTheLastOneUntilTheNextIsReady) {
    Hydra hydra(true);
    SeaParameters parameters = asked();
    hydra.ask(parameters);
    EXPECT_TRUE(hydra.children.empty());
    hydra.wait();
    expect_same(hydra.given(), expand(parameters));
    EXPECT_EQ(hydra.poll(), HdGpGenerativeProcedural::Finished);
    // A newer frame ends the work on an older one, which is never shown.
    const HdDataSourceBaseHandle first = hydra.mesh();
    for (const double frame : {13.0, 14.0, 15.0}) {
        parameters.frame = frame;
        hydra.ask(parameters);
        EXPECT_EQ(hydra.mesh(), first);
    }
    hydra.wait();
    EXPECT_EQ(hydra.dirtied.size(), 1u);
    expect_same(hydra.given(), expand(parameters));
    EXPECT_TRUE(Hydra::log().empty());
}

// Of a sea that is long in the making, and of a frame beyond the last one, whose camera is refused then: who ends the work never hears of
// that.
TEST_F(HydraSea, EndsWorkThatNobodyWaitsFor) {
    SeaParameters parameters = asked();
    parameters.shot = write("long.toml", text_with("resolution = 256", "resolution = 2048"));
    parameters.finest_cell_m = 0.0;
    parameters.frame = 1e8 + 1.0;
    parameters.shutter_open = parameters.shutter_close = -1.0;
    for (const bool is_ended : {false, true}) {
        auto hydra = std::make_unique<Hydra>(true);
        hydra->ask(parameters);
        if (!is_ended) hydra->wait();
        hydra.reset();
        EXPECT_EQ(Hydra::log().size(), is_ended ? 0u : 1u);
    }
}

}  // namespace
