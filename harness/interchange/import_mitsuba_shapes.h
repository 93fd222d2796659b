// Converts the shapes of a Mitsuba scene to objects of a scene file.
#pragma once

#include <vector>

#include "harness/interchange/import_mitsuba_material.h"

namespace pt {

class MitsubaShapes {
public:
    explicit MitsubaShapes(const MitsubaFile& file) : file_(&file), materials_(file) {}

    // Converts a shape that stands directly in the Mitsuba scene. Shapes must be added in the file's order.
    void add(const XmlElement& shape);
    // Writes all objects, after the last shape was added. `eye`: the camera's position, since the gap allowed between
    // emitters back to back grows with the distance from it.
    void write(const Vec3d& eye);
    // Handles what needs the whole scene: backs of one-sided emitters, emitters inside glass, and warnings about
    // differences between the two programs.
    void write_whole(const Scene& scene);

    const MitsubaMaterials& materials() const { return materials_; }

private:
    struct Placed {
        std::string kind;  // name of the shape in scene files
        Affine own;        // affine map that places the unit shape of scene files
        Affine map;        // affine map that places Mitsuba's unit shape
        MitsubaSurface surface;
        std::string mesh;  // file of the shape if it is a mesh
        bool is_flipped = false;
        bool is_pair = false;  // two-sided quad that stands for two emitters back to back
        bool is_gone = false;  // second of two emitters back to back, which is left out
        bool flips_v = false;  // whether Mitsuba turns v of the mesh file into 1 - v
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
    std::map<std::string, std::string> turned_;  // meshes written anew with v flipped, by the original's path
};

}  // namespace pt
