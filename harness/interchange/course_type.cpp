#include "harness/interchange/course_type.h"

#include <map>
#include <set>

#include "harness/interchange/course_words.h"

namespace pt {

namespace {

const std::map<std::string, CourseType>& course_types() {
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
        {"SPECULAR TRANSMISSIVE", glass},
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
    return types;
}

const std::set<std::string> procedural_types{"PROCEDURAL", "MARBLE", "WOOD", "CHECKER", "NOISE"};

}  // namespace

bool is_course_type(const std::string& word) {
    const std::string name = course_spelling(word);
    return course_types().contains(name) || procedural_types.contains(name);
}

CourseType read_course_type(Cis565SectionReader& reader, const Cis565Line& line) {
    const std::string name = line.words.size() == 2 ? course_spelling(line.words[1]) : "";
    const auto found = course_types().find(name);
    if (found != course_types().end()) {
        return found->second;
    }
    reader.fail(line, procedural_types.contains(name)
                          ? missing_for(CourseUse::procedural)
                          : "Diffuse, Emitting, Specular, Mirror, Metal, Refractive, Glass, PBR, Microfacet, Disney, "
                            "Plastic or Subsurface");
    return CourseType::by_values;
}

}  // namespace pt
