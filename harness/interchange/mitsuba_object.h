// An object of a Mitsuba file, <bsdf type="diffuse" id="white">, with its properties: asked for by name, and what
// nobody asked for is a problem. How values are written: src/core/parser.cpp of Mitsuba 3.
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

// A Mitsuba file that is imported: the draft of the scene, and the elements that references name.
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

// Reads numbers with commas or white space between them; nothing where something else is there.
std::optional<std::vector<double>> mitsuba_numbers(const std::string& text);

class MitsubaObject {
public:
    MitsubaObject(const XmlElement& element, const MitsubaFile& file) : element_(&element), file_(&file) {}

    const XmlElement& element() const { return *element_; }
    const MitsubaFile& file() const { return *file_; }
    std::string type() const { return element_->value_of("type"); }
    std::string id() const { return element_->value_of("id"); }
    bool is_good() const { return is_good_; }

    // The property of that name, or null; it counts as asked for by finish().
    const XmlElement* property(const std::string& name);
    // The objects of that tag among the children, references followed.
    std::vector<const XmlElement*> objects(const std::string& tag);
    // Passes over properties without which the picture is the same, or which belong to a run.
    void ignore(const std::vector<std::string>& names);
    // Refuses a property that is of no use with what else is there: a problem where it has another value than `allowed`
    // says in words.
    void refuse_property(const std::string& name, const std::string& allowed);

    // These read a property of this name. One that is not there has the value `otherwise`; one that cannot be read is a
    // problem.
    double number(const std::string& name, double otherwise);
    std::optional<double> optional_number(const std::string& name);
    bool boolean(const std::string& name, bool otherwise);
    std::string text(const std::string& name, const std::string& otherwise);
    Vec3d colour(const std::string& name, const Vec3d& otherwise);
    std::optional<Vec3d> optional_colour(const std::string& name);
    // The radiance of an emitter, for which Mitsuba's RGB variants have another grey for a <spectrum>.
    std::optional<Vec3d> optional_radiance(const std::string& name);
    Vec3d point(const std::string& name, const Vec3d& otherwise);
    Affine transform(const std::string& name);

    void fail(const XmlElement& element, const std::string& allowed);
    // Marks the object as bad for what is wrong within an object of its own, and told.
    void spoil() { is_good_ = false; }
    // Ends the reading: a property that was not asked for is a problem. `known` says in words what the object may have.
    void finish(const std::string& known);

private:
    Affine transform_of(const XmlElement& step);
    Vec3d vector_of(const XmlElement& element, double otherwise);

    const XmlElement* element_;
    const MitsubaFile* file_;
    std::set<const XmlElement*> asked_;
    bool is_good_ = true;
};

// Mitsuba's look_at as a map, with the columns left, up and forward.
Affine look_at_map(const Vec3d& origin, const Vec3d& target, const Vec3d& up);

}  // namespace pt
