// An XML file as a tree of elements, each with its line: what an importer needs of XML 1.0. pugixml reads it where the
// build has that library.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "harness/interchange/import_findings.h"

namespace pt {

struct XmlElement {
    std::string tag;
    std::vector<std::pair<std::string, std::string>> attributes;
    std::vector<XmlElement> children;  // elements only: text and comments are left out
    std::size_t line = 0;              // from 1

    // The value of an attribute; null where there is none of that name.
    const std::string* attribute(const std::string& name) const;
    // The value of an attribute, or "".
    std::string value_of(const std::string& name) const;
    // The start tag, cut where it is more than a message should hold.
    std::string text() const;
};

// The element that holds all others; nothing, and a problem, where the text is no XML or beyond the limits (64 levels,
// 10^6 elements).
std::optional<XmlElement> read_xml(const std::string& text, ImportFindings& problems);

// Whether the build found what reads XML (pugixml); without it every text is a problem that says so.
bool reads_xml();

}  // namespace pt
