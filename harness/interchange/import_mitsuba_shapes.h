// The shapes of a Mitsuba file as objects of a scene file.
#pragma once

#include <vector>

#include "harness/interchange/import_mitsuba_material.h"

namespace pt {

class MitsubaShapes {
public:
    explicit MitsubaShapes(const MitsubaFile& file) : file_(&file), materials_(file) {}

    // Takes a shape that stands in the scene itself; shapes are to come in the file's order.
    void add(const XmlElement& shape);
    // Writes the objects, once all shapes are there. `eye` tells what is far.
    void write(const Vec3d& eye);
    // What takes the scene as a whole: what stands behind lamps of one side, lamps in glass, and what is different here
    // and there.
    void write_whole(const Scene& scene);

    const MitsubaMaterials& materials() const { return materials_; }

private:
    struct Placed {
        std::string kind;  // of scene files
        Affine own;        // from the space of scene files' shapes
        Affine map;        // from that of Mitsuba's
        MitsubaSurface surface;
        std::string mesh;  // its file
        bool is_flipped = false;
        bool is_pair = false;  // of two lamps back to back: shines to both sides
        bool is_gone = false;  // the other of such a pair
        bool flips_v = false;  // of a mesh: Mitsuba has 1 - v of its file
        std::size_t object = no_object;
        std::size_t material = 0;
    };
    static constexpr std::size_t no_object = ~std::size_t{0};

    void add_placed(const XmlElement& shape, const Affine& outer, int depth);
    bool read_surface(MitsubaObject& object, MitsubaSurface& surface);
    bool read_sphere(MitsubaObject& object, const Affine& outer, Placed& placed);
    bool read_mesh_file(MitsubaObject& object, Placed& placed);
    void add_instance(MitsubaObject& object, const Affine& outer, int depth);
    void pair_lamps(const Vec3d& eye);
    bool lay_image(Placed& placed, MitsubaImage image);
    bool lay_image_on_mesh(Placed& placed, bool turns_v);
    bool are_back_to_back(const Placed& a, const Placed& b, double far) const;
    void write_behind(const Scene& scene);
    void dim_lamps_in_glass(const Scene& scene);
    void warn_of_sides(const Scene& scene);
    void warn_of_differences(const Scene& scene);

    const MitsubaFile* file_;
    MitsubaMaterials materials_;
    std::vector<Placed> shapes_;
    std::size_t visits_ = 0;
    std::map<std::string, std::string> turned_;  // meshes whose v is turned round, by their files
};

}  // namespace pt
