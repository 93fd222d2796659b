#include "harness/scene/course_type.h"

#include <map>
#include <set>

#include "harness/scene/course_words.h"

namespace pt {

CourseType read_course_type(Cis565SectionReader& reader, const Cis565Line& line) {
    using enum CourseType;
    static const std::map<std::string, CourseType> types{
        {"DIFFUSE", diffuse},
        {"LAMBERT", diffuse},
        {"LAMBERTIAN", diffuse},
        {"MATTE", diffuse},
        {"EMITTING", emitter},
        {"EMISSIVE", emitter},
        {"EMITTER", emitter},
        {"LIGHT", emitter},
        {"GLOSSY", by_values},
        {"SPECULAR", specular},
        {"MIRROR", specular},
        {"REFLECT", specular},
        {"REFLECTIVE", specular},
        {"PUREREFLECTION", specular},
        {"CONDUCTOR", specular},
        {"METAL", specular},
        {"TORRANCESPARROW", specular},
        {"REFRACTIVE", glass},
        {"REFRACT", glass},
        {"REFRACTION", glass},
        {"DIELECTRIC", glass},
        {"GLASS", glass},
        {"TRANSMISSIVE", glass},
        {"TRANSPARENT", glass},
        {"PERFECTSPECULAR", glass},
        {"PURETRANSMISSION", glass},
        {"PBR", layered},
        {"MICROFACET", layered},
        {"MICROFACETPBR", layered},
        {"DISNEY", layered},
        {"PLASTIC", layered},
        {"SUBSURFACE", subsurface},
    };
    static const std::set<std::string> procedural{"PROCEDURAL", "MARBLE", "WOOD", "CHECKER", "NOISE"};
    const std::string name = line.words.size() == 2 ? course_spelling(line.words[1]) : "";
    const auto found = types.find(name);
    if (found != types.end()) {
        return found->second;
    }
    reader.fail(line, procedural.contains(name)
                          ? missing_for(CourseUse::procedural)
                          : "Diffuse, Emitting, Specular, Mirror, Metal, Refractive, Glass, PBR, Microfacet, Disney, "
                            "Plastic or Subsurface");
    return by_values;
}

}  // namespace pt
