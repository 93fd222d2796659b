// Reads the properties of a Mitsuba XML object, such as <bsdf type="diffuse" id="white">, by name. Properties that no
// caller asked for are problems. Syntax of values: src/core/parser.cpp of Mitsuba 3.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "harness/interchange/affine.h"
#include "harness/interchange/import_draft.h"
#include "harness/interchange/xml_document.h"

namespace pt {

// The Mitsuba file under import: the draft of the scene, and the elements that references can name.
struct MitsubaFile {
    ImportDraft* draft;
    std::map<std::string, const XmlElement*> by_id;

    const Cis565Line* place(const XmlElement& element) const { return draft->place(element.line, element.text()); }
    void refuse(const XmlElement& element, const std::string& allowed) const {
        draft->refuse({.number = element.line, .words = {element.text()}}, allowed);
    }
    void warn(const XmlElement& element, const std::string& what) const {
        draft->warnings().add(element.line, element.text() + " " + what);
    }
    void note(const XmlElement& element, const std::string& what) const {
        draft->notes().add(element.line, element.text() + " " + what);
    }
};

// Parses numbers separated by commas or white space; nothing if the text has anything else.
std::optional<std::vector<double>> mitsuba_numbers(const std::string& text);

class MitsubaObject {
public:
    MitsubaObject(const XmlElement& element, const MitsubaFile& file) : element_(&element), file_(&file) {}

    const XmlElement& element() const { return *element_; }
    const MitsubaFile& file() const { return *file_; }
    std::string type() const { return element_->value_of("type"); }
    std::string id() const { return element_->value_of("id"); }
    bool is_good() const { return is_good_; }

    // Finds a property of the Mitsuba object by name, or null, and marks it as asked for.
    const XmlElement* property(const std::string& name);
    // All children of the Mitsuba object with a given tag, references followed.
    std::vector<const XmlElement*> objects(const std::string& tag);
    // Ignores properties that do not change the picture or that belong to a run.
    void ignore(const std::vector<std::string>& names);
    // Reports a problem if the Mitsuba object has a property that is of no use with its other properties. `allowed`
    // says in words which value would do.
    void refuse_property(const std::string& name, const std::string& allowed);

    // Read a property of the Mitsuba object by name: `otherwise` if it is missing, a problem if it cannot be read.
    double number(const std::string& name, double otherwise);
    std::optional<double> optional_number(const std::string& name);
    bool boolean(const std::string& name, bool otherwise);
    std::string text(const std::string& name, const std::string& otherwise);
    Vec3d colour(const std::string& name, const Vec3d& otherwise);
    std::optional<Vec3d> optional_colour(const std::string& name);
    // Radiance of an emitter. Mitsuba's RGB variants make another grey of a <spectrum> in an emitter than elsewhere.
    std::optional<Vec3d> optional_radiance(const std::string& name);
    Vec3d point(const std::string& name, const Vec3d& otherwise);
    Affine transform(const std::string& name);

    void fail(const XmlElement& element, const std::string& allowed);
    // Marks the object as bad because of a problem in a child that was reported already.
    void spoil() { is_good_ = false; }
    // Ends the reading of the Mitsuba object: properties not asked for are problems. `known` says what it may have.
    void finish(const std::string& known);

private:
    Affine transform_of(const XmlElement& step);
    Vec3d vector_of(const XmlElement& element, double otherwise);

    const XmlElement* element_;
    const MitsubaFile* file_;
    std::set<const XmlElement*> asked_;
    bool is_good_ = true;
};

// The affine map of Mitsuba's look_at, with the columns left, up and forward.
Affine look_at_map(const Vec3d& origin, const Vec3d& target, const Vec3d& up);

}  // namespace pt
