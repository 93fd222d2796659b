#include "harness/interchange/course_words.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <stdexcept>

#include "harness/words.h"

namespace pt {

namespace {

using Words = std::map<std::string, CourseWord>;

void add(Words& words, const char* key, CourseUse use, const std::vector<const char*>& spellings) {
    for (const char* spelling : spellings) {
        words.emplace(spelling, CourseWord{key, use});
    }
}

void add_all(Words& words, CourseUse use, const std::vector<const char*>& spellings) {
    for (const char* spelling : spellings) {
        words.emplace(spelling, CourseWord{spelling, use});
    }
}

Words material_words() {
    Words words;
    add(words, "RGB", CourseUse::value, {"RGB", "COLOR", "ALBEDO"});
    add(words, "SPECEX", CourseUse::value, {"SPECEX"});
    add(words, "SPECRGB", CourseUse::value, {"SPECRGB", "SPECULARCOLOR"});
    add(words, "REFL", CourseUse::value, {"REFL", "REFLECTIVE", "HASREFLECTIVE"});
    add(words, "REFR", CourseUse::value,
        {"REFR", "REFRACT", "REFRACTIVE", "HASREFRACTIVE", "TRANSMISSIVE", "TRANSMISSION", "TRANSPARENCY"});
    add(words, "REFRIOR", CourseUse::value, {"REFRIOR", "IOR", "ETA", "INDEXOFREFRACTION", "REFRACTION", "RIOR"});
    add_all(words, CourseUse::value, {"EMITTANCE", "SIGMAA", "SIGMAS", "ROUGHNESS", "METALLIC", "TYPE"});
    add_all(words, CourseUse::remark, {"NAME", "COMMENT", "PROCTEXNUM"});
    add_all(
        words, CourseUse::lost,
        {"DISPERSION", "CLEARCOAT", "CLEARCOATGLOSS", "SHEEN", "SPECULAR", "FRESNELPOW", "REFLECTIONODDS", "ABSCOEFF",
         "ABSORPTION", "RSCTCOEFF", "SCATTER", "ROUGH", "THICKNESS", "DISTORTION", "GLOW", "BSSRDFSCALE", "AMBIENT"});
    add(words, "TEXTURE", CourseUse::image,
        {"TEXTURE", "DIFFUSEMAP", "DIFFUSETEXTURE", "DIFFUSE", "DPATH", "ALBEDOMAP"});
    add_all(words, CourseUse::texture,
            {"NORMALMAP", "NORMALTEXTURE", "NORMAL", "NPATH", "BUMPTEXTURE", "METALLICROUGHNESS", "BUMP", "BUMPMAP",
             "ROUGHNESSMAP", "METALLICMAP"});
    add_all(words, CourseUse::procedural,
            {"PROTEX", "USINGPROCTEX", "RGB1", "RGB2", "LIGHTRGB", "DARKRGB", "CHECKERCOLOR1", "CHECKERCOLOR2",
             "CHECKERSIZE", "SCALE", "FREQ", "WARP", "OCTAVES", "NOISE"});
    add_all(words, CourseUse::scattering, {"SUBSURFACE", "ISSUBSURFACE"});
    return words;
}

Words camera_words() {
    Words words;
    add_all(words, CourseUse::value,
            {"RES", "FOVY", "ITERATIONS", "DEPTH", "FILE", "EYE", "LOOKAT", "VIEW", "UP", "APERTURE", "DOF"});
    add(words, "LENSRADIUS", CourseUse::value,
        {"LENSRADIUS", "LENRADIUS", "LENSRAD", "LENSR", "LRADIUS", "LENS", "APERTURERADIUS", "RADIUS"});
    add(words, "FOCALDIST", CourseUse::value,
        {"FOCALDIST", "FOCALD", "FOCAL", "FOCALDISTANCE", "FOCALLENGTH", "FOCUSDIS", "FOCUSDIST", "FOCUSDISTANCE",
         "FLENGTH"});
    add_all(words, CourseUse::remark, {"FRAME", "INVRES", "NAME", "COMMENT"});
    add_all(words, CourseUse::run, {"SPP", "SAMPLES", "AA", "ANTIALIAS"});
    add_all(words, CourseUse::lost, {"ROTAT"});
    add(words, "ENVIRONMENT", CourseUse::value, {"ENVMAP", "ENVIRONMENT", "SKYBOX"});
    add_all(words, CourseUse::texture, {"TEXTURE"});
    return words;
}

Words object_words() {
    Words words;
    add(words, "cube", CourseUse::value, {"CUBE", "BOX"});
    add(words, "sphere", CourseUse::value, {"SPHERE"});
    add(words, "rect", CourseUse::value, {"RECT"});
    add(words, "mesh", CourseUse::value,
        {"MESH", "OBJ", "GLTF", "GLB", "OBJFILE", "CUSTOMOBJ", "CUSTOMGLTF", "MESHGLTF", "MESHOBJ", "MODEL", "CUSTOM"});
    add(words, "material", CourseUse::value, {"MATERIAL"});
    add(words, "TRANS", CourseUse::value, {"TRANS", "TRANSLATE", "POSITION"});
    add(words, "ROTAT", CourseUse::value, {"ROTAT", "ROTATE", "ROTATION"});
    add(words, "SCALE", CourseUse::value, {"SCALE", "SIZE"});
    add(words, "FILE", CourseUse::value, {"FILE", "PATH", "FILENAME", "FILEPATH"});
    add(words, "ANIMET", CourseUse::value, {"ANIMET", "ANIME"});
    add(words, "TRANS_DST", CourseUse::value, {"TRANSDST"});
    add(words, "ROTAT_DST", CourseUse::value, {"ROTATDST"});
    add(words, "SCALE_DST", CourseUse::value, {"SCALEDST"});
    add(words, "T_MOTION", CourseUse::value, {"TMOTION"});
    add(words, "ANIMER", CourseUse::value, {"ANIMER", "RMOTION"});
    add_all(words, CourseUse::value, {"VEL", "RADIUS", "VERTICES"});
    add_all(words, CourseUse::remark, {"FRAME", "NAME", "COMMENT", "BUILDBVH"});
    add_all(words, CourseUse::texture, {"TEXTURE", "BUMP", "NORMALMAP", "EXTERNALMATERIAL"});
    add_all(words, CourseUse::procedural, {"IMPLICIT", "CSG", "TANGLECUBE", "SDF", "TORUS"});
    return words;
}

Words settings_words() {
    Words words;
    add(words, "DOF", CourseUse::value, {"USEDOF"});
    add_all(words, CourseUse::run,
            {"SORTMATERIALS", "CACHEBOUNCE", "ANTIALIAS", "USEBBOX", "ADAPTIVESAMPLING", "MINSAMPLES", "PIXVARIANCE"});
    return words;
}

Words root_words() {
    Words words;
    add(words, "Materials", CourseUse::value, {"MATERIALS"});
    add(words, "Camera", CourseUse::value, {"CAMERA"});
    add(words, "Objects", CourseUse::value, {"OBJECTS"});
    add(words, "Meshes", CourseUse::value, {"MESHES"});
    add(words, "BACKGROUND_COLOR", CourseUse::background, {"BACKGROUNDCOLOR"});
    add_all(words, CourseUse::remark, {"NAME", "COMMENT", "DESCRIPTION"});
    add_all(words, CourseUse::environment, {"ENVIRONMENT", "ENVIRONMENTMAP", "ENVMAP", "BACKGROUND", "SKYBOX"});
    add_all(words, CourseUse::lights, {"LIGHTS", "GLTF"});
    return words;
}

const Words& words_of(const std::string& section) {
    static const std::map<std::string, Words> sections{{"MATERIAL", material_words()},
                                                       {"CAMERA", camera_words()},
                                                       {"OBJECT", object_words()},
                                                       {"SETTINGS", settings_words()},
                                                       {"ROOT", root_words()}};
    return sections.at(section);
}

bool is_off_value(const std::string& value) {
    static const std::set<std::string> words{"", "NULL", "NONE", "OFF", "FALSE"};
    if (words.contains(course_spelling(value))) {
        return true;
    }
    return parse_number<double>(value) == 0.0;
}

}  // namespace

const CourseWord* find_course_word(const std::string& section, const std::string& word) {
    const Words& words = words_of(section);
    const auto found = words.find(course_spelling(word));
    return found == words.end() ? nullptr : &found->second;
}

const std::vector<std::string>& course_keys(const std::string& section) {
    static const std::map<std::string, std::vector<std::string>> keys{
        {"MATERIAL",
         {"RGB", "SPECEX", "SPECRGB", "REFL", "REFR", "REFRIOR", "EMITTANCE", "SIGMAA", "SIGMAS", "ROUGHNESS",
          "METALLIC", "TYPE", "TEXTURE"}},
        {"CAMERA",
         {"RES", "FOVY", "ITERATIONS", "DEPTH", "FILE", "EYE", "LOOKAT", "VIEW", "UP", "LENSRADIUS", "FOCALDIST"}},
        {"OBJECT", {"cube", "sphere", "rect", "mesh", "material", "TRANS", "ROTAT", "SCALE", "VEL", "FILE"}},
        {"SETTINGS", {"USE_DOF"}},
        {"ROOT", {"Materials", "Camera", "Objects"}},
    };
    return keys.at(section);
}

std::string missing_for(CourseUse use) {
    switch (use) {
        case CourseUse::texture:
            return "no image here (TEXTURE of a material is read; no normal, bump or roughness map is)";
        case CourseUse::procedural:
            return "no procedural shape or pattern (scene files have none)";
        case CourseUse::scattering:
            return "no scattering below a surface but by SIGMAS";
        case CourseUse::lights:
            return "lights and meshes among the objects";
        default:
            throw std::logic_error("a use that is not refused");
    }
}

std::string course_spelling(const std::string& word) {
    std::string spelling;
    for (const unsigned char c : word) {
        if (c != '_' && c != '-') {
            spelling += static_cast<char>(std::toupper(c));
        }
    }
    return spelling;
}

bool is_course_off(const std::string& key, const std::vector<std::string>& values) {
    // Keyword values that leave a CIS 565 scene as it is: Schlick's power 5, one sample per pixel, antialiasing on.
    static const std::map<std::string, std::string> neutral{{"FRESNELPOW", "5"}, {"SPP", "1"}, {"AA", "ON"}};
    const auto found = neutral.find(key);
    if (found != neutral.end() && values.size() == 1 && values[0] == found->second) {
        return true;
    }
    return std::all_of(values.begin(), values.end(), is_off_value);
}

}  // namespace pt
