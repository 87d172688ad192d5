// output.mesh_scheme = "catmullClark": what a reader that subdivides makes of a baked cage. OpenSubdiv has the limit surface
// of the file's faces and points; the sea is the query's.
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <nlohmann/json.hpp>
#include <random>

#include "tests/plugin/bake/baked_mesh.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;
namespace osd = OpenSubdiv;

// What is interpolated at the limit surface of a mesh as its layers declare it.
class Limit {
  public:
    explicit Limit(const Mesh& mesh) {
        const std::vector<int> corners(mesh.corners.size() / 4, 4);
        osd::Far::TopologyDescriptor topology;
        topology.numVertices = static_cast<int>(mesh.points.size());
        topology.numFaces = static_cast<int>(corners.size());
        topology.numVertsPerFace = corners.data();
        topology.vertIndicesPerFace = mesh.corners.data();
        osd::Sdc::Options scheme;
        scheme.SetVtxBoundaryInterpolation(osd::Sdc::Options::VTX_BOUNDARY_NONE);
        using Factory = osd::Far::TopologyRefinerFactory<osd::Far::TopologyDescriptor>;
        refiner_.reset(Factory::Create(topology, Factory::Options(osd::Sdc::SCHEME_CATMARK, scheme)));
        osd::Far::PatchTableFactory::Options options(1);
        refiner_->RefineAdaptive(options.GetRefineAdaptiveOptions());
        table_.reset(osd::Far::PatchTableFactory::Create(*refiner_, options));
        map_ = std::make_unique<osd::Far::PatchMap>(*table_);
    }

    bool has(int face) const { return map_->FindPatch(face, 0.5, 0.5) != nullptr; }

    struct At {
        glm::dvec3 value{0.0}, along_u{0.0}, along_v{0.0};
    };
    At at(int face, double u, double v, const std::vector<glm::vec3>& values) const {
        const auto* patch = map_->FindPatch(face, u, v);
        std::array<double, 20> w{}, du{}, dv{};
        table_->EvaluateBasis(*patch, u, v, w.data(), du.data(), dv.data());
        const auto vertices = table_->GetPatchVertices(*patch);
        At at;
        for (int i = 0; i < vertices.size(); ++i) {
            const glm::dvec3 value(values[static_cast<std::size_t>(vertices[i])]);
            const auto k = static_cast<std::size_t>(i);
            at.value += w[k] * value;
            at.along_u += du[k] * value;
            at.along_v += dv[k] * value;
        }
        return at;
    }

  private:
    std::unique_ptr<osd::Far::TopologyRefiner> refiner_;
    std::unique_ptr<osd::Far::PatchTable> table_;
    std::unique_ptr<osd::Far::PatchMap> map_;
};

constexpr double kSize_m = 64.0;
constexpr int kQuads = 64;

// Its shortest wave is four cells long.
Scene scene_of(MeshScheme scheme) {
    Scene scene;
    scene.shot.last_frame = 4;
    scene.shot.time_scale = 0.5;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.cascades = {{.size_m = kSize_m, .resolution = kQuads / 2}};
    scene.waves.tiling = Tiling::Periodic;
    scene.surface.size_m = kSize_m;
    scene.surface.resolution = kQuads;
    scene.output.mesh_scheme = scheme;
    return scene;
}

// Root mean squares over the patch, its edges included.
struct Errors {
    double surface_m = 0.0, normal = 0.0, velocity_mps = 0.0;
};

// The sea where a cell's (u, v) rests.
struct Exact {
    std::vector<glm::ivec2> cells;
    std::vector<glm::dvec2> in_cell;
    std::vector<glm::dvec3> position_m, normal, velocity_mps;
};
Exact exact_sea(int frame) {
    constexpr std::size_t kPoints = 4000;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> across(0.0, kQuads);
    Exact exact;
    std::vector<glm::dvec2> rest;
    for (std::size_t i = 0; i < kPoints; ++i) {
        glm::dvec2 at(across(random), across(random));
        if (i % 8 == 0) at.x = i % 16 == 0 ? 0.0 : kQuads;
        exact.cells.push_back(glm::min(glm::ivec2(at), glm::ivec2(kQuads - 1)));
        exact.in_cell.push_back(at - glm::dvec2(exact.cells.back()));
        rest.push_back((at / static_cast<double>(kQuads) - 0.5) * kSize_m);
    }
    const Scene scene = scene_of(MeshScheme::None);
    Query query;
    query.name = "exact";
    query.products = products(Product::Position, Product::Normal, Product::Velocity);
    query.points = kPoints;
    const Plan plan = make_plan(scene, {query}, {.double_precision = true});
    Frame<double> sea(std::make_shared<const Sea<double>>(plan));
    sea.set(scene.shot.time_s(frame));
    exact.position_m.resize(kPoints);
    exact.normal.resize(kPoints);
    exact.velocity_mps.resize(kPoints);
    Results<double> results;
    results.set(Product::Position, {exact.position_m.data()});
    results.set(Product::Normal, {exact.normal.data()});
    results.set(Product::Velocity, {exact.velocity_mps.data()});
    evaluate(sea, 0, {.count = kPoints, .rest_m = {rest.data()}}, results);
    return exact;
}

template <class At>
Errors errors_of(const Exact& exact, const At& at) {
    Errors sum;
    for (std::size_t i = 0; i < exact.cells.size(); ++i) {
        const auto [position, normal, velocity] = at(exact.cells[i], exact.in_cell[i]);
        const double off = glm::dot(position - exact.position_m[i], exact.normal[i]);
        sum.surface_m += off * off;
        sum.normal += std::pow(glm::distance(normal, exact.normal[i]), 2.0);
        sum.velocity_mps += std::pow(glm::distance(velocity, exact.velocity_mps[i]), 2.0);
    }
    for (double* error : {&sum.surface_m, &sum.normal, &sum.velocity_mps})
        *error = std::sqrt(*error / static_cast<double>(exact.cells.size()));
    return sum;
}

class FittedCageTest : public BakedMeshes {
  protected:
    nlohmann::json record_of(const Scene& scene) const {
        return nlohmann::json::parse(bytes_of(folder_ / (scene.shot.name + ".json")));
    }
};

TEST_F(FittedCageTest, TheLimitSurfaceIsTheSea) {
    constexpr int kFrame = 3;
    const Exact exact = exact_sea(kFrame);
    const Scene plain = scene_of(MeshScheme::None);
    const Mesh mesh = baked(plain, kFrame);
    const nlohmann::json plain_record = record_of(plain);
    const Errors of_mesh = errors_of(exact, [&](glm::ivec2 cell, glm::dvec2 in) {
        const auto a = static_cast<std::size_t>(cell.y * (kQuads + 1) + cell.x);
        const std::array corners{a, a + 1, a + kQuads + 1, a + kQuads + 2};
        const std::array weights{(1.0 - in.x) * (1.0 - in.y), in.x * (1.0 - in.y), (1.0 - in.x) * in.y,
                                 in.x * in.y};
        std::array<glm::dvec3, 3> values{};
        for (std::size_t c = 0; c < 4; ++c) {
            values[0] += weights[c] * glm::dvec3(mesh.points[corners[c]]);
            values[1] += weights[c] * glm::dvec3(mesh.normals[corners[c]]);
            values[2] += weights[c] / plain.shot.time_scale * glm::dvec3(mesh.velocities[corners[c]]);
        }
        values[1] = glm::normalize(values[1]);
        return values;
    });
    for (const MeshFormat format : {MeshFormat::Usdc, MeshFormat::Usda}) {
        Scene scene = scene_of(MeshScheme::CatmullClark);
        scene.output.mesh = format;
        const Mesh cage = baked(scene, kFrame);
        const Limit limit(cage);
        constexpr int kFacesPerSide = kQuads + 2;
        // The ring is no part of the surface.
        for (int face = 0; face < kFacesPerSide * kFacesPerSide; ++face) {
            const int x = face % kFacesPerSide, y = face / kFacesPerSide;
            EXPECT_EQ(limit.has(face), x > 0 && y > 0 && x <= kQuads && y <= kQuads);
        }
        EXPECT_TRUE(cage.normals.empty());
        const Errors of_cage = errors_of(exact, [&](glm::ivec2 cell, glm::dvec2 in) {
            const int face = (cell.y + 1) * kFacesPerSide + cell.x + 1;
            const Limit::At at = limit.at(face, in.x, in.y, cage.points);
            return std::array{at.value, glm::normalize(glm::cross(at.along_u, at.along_v)),
                              limit.at(face, in.x, in.y, cage.velocities).value / scene.shot.time_scale};
        });
        EXPECT_LT(of_cage.surface_m, of_mesh.surface_m / 20.0);
        EXPECT_LT(of_cage.normal, of_mesh.normal / 8.0);
        EXPECT_LT(of_cage.velocity_mps, of_mesh.velocity_mps / 20.0);

        // The record is about the patch, whatever the file holds.
        const nlohmann::json record = record_of(scene);
        const nlohmann::json &ours = record.at("frames").front(), &theirs = plain_record.at("frames").front();
        for (const char* statistic : {"mesh_hs_m", "whitecap_coverage"})
            EXPECT_EQ(ours.at(statistic), theirs.at(statistic)) << statistic;
    }
}

// Renderers don't smooth "varying" values: each vertex has the sea's own.
TEST_F(FittedCageTest, ValuesThatAreNotSmoothedAreThePatchs) {
    std::map<std::string, std::vector<float>> patch;
    for (const MeshScheme scheme : {MeshScheme::None, MeshScheme::CatmullClark}) {
        const Scene scene = scene_of(scheme);
        baked(scene, 2);
        const usd::MeshLayer layer =
            usd::read_mesh_layer(bytes_of(folder_ / usd::frame_file(scene.shot.name, 2, "usdc")));
        const bool is_cage = scheme == MeshScheme::CatmullClark;
        std::size_t compared = 0;
        for (const usd::MeshArray& array : layer.arrays) {
            if (!array.name.starts_with("primvars:")) continue;
            const auto& values = std::get<std::vector<float>>(array.values);
            if (!is_cage) {
                patch[array.name] = values;
                continue;
            }
            ++compared;
            const auto components = static_cast<std::size_t>(array.components);
            for (std::size_t y = 0; y <= kQuads; ++y)
                for (std::size_t x = 0; x < (kQuads + 1) * components; ++x)
                    ASSERT_EQ(values[(y + 1) * (kQuads + 3) * components + components + x],
                              patch[array.name][y * (kQuads + 1) * components + x])
                        << array.name;
        }
        EXPECT_EQ(compared, is_cage ? patch.size() : 0u);
    }
    EXPECT_EQ(patch.size(), 4u);  // slope variance, coverage, its active part and age
}

}  // namespace
