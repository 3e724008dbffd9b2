// The XML Schema of a WSDL document's <types>: which parts an element has, and of which datatypes. Private to this folder. One
// thread.
#ifndef DOCENT_WORKFLOW_TEMPLATES_WSDL_SCHEMA_H_
#define DOCENT_WORKFLOW_TEMPLATES_WSDL_SCHEMA_H_

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "workflow/templates/node_template.h"
#include "workflow/xml/xml_document.h"

namespace docent::templates {

using QName = std::pair<std::string, std::string>;  // namespace, local name

// Things that have names. A name points to the thing of this name; or else, since documents are often careless about namespaces,
// to the only one of its local name.
template <typename Thing>
class NamedThings {
 public:
  // False: there is one of this name, which stays.
  bool Add(const QName& name, Thing thing) {
    const auto [place, is_new] = things_.try_emplace(name, std::move(thing));
    if (!is_new) return false;
    const auto [only, alone] = by_local_name_.try_emplace(name.second, &place->second);
    if (!alone) only->second = nullptr;
    return true;
  }
  const Thing* Find(const QName& name) const {
    if (const auto found = things_.find(name); found != things_.end()) return &found->second;
    const auto only = by_local_name_.find(name.second);
    return only == by_local_name_.end() ? nullptr : only->second;
  }

 private:
  std::map<QName, Thing> things_;
  std::map<std::string, const Thing*> by_local_name_;  // null: there are several
};

// The value of a QName attribute; `default_ns` where it has no prefix and there is no default namespace.
QName ResolveName(const xml::Element& at, std::string_view text, const std::string& default_ns);
// An attribute without namespace, trimmed; empty: there is none.
std::string AttributeOf(const xml::Element& element, std::string_view name);

class WsdlSchema {
 public:
  // Told of what is worth a warning: the element, what, hint.
  using Report = std::function<void(const xml::Element&, std::string message, std::string hint)>;

  explicit WsdlSchema(Report report) : report_(std::move(report)) {}

  // A <schema>; its elements must outlive this.
  void Add(const xml::Element& schema);
  // The parts that an element of this name has: those inside of it, or itself where it is of a simple type. `at` refers to it.
  void AddPartsOfElement(const xml::Element& at, const QName& name, std::vector<TemplatePart>* parts);
  // The datatype or class of a type's name.
  std::string TypeOfName(const QName& name) const { return TypeOfName(name, 0); }

 private:
  struct Declared {
    const xml::Element* element = nullptr;
    std::string name_space;
  };

  // False: all steps are used up, or there are too many parts.
  bool AddDeclared(const Declared& declared, int depth, std::vector<TemplatePart>* parts);
  bool AddContent(const Declared& type, const std::string& own_name, int depth,
                  std::vector<TemplatePart>* parts);
  bool AddChild(const Declared& child, std::vector<TemplatePart>* parts);
  std::string TypeOfName(const QName& name, int depth) const;
  std::string TypeOfSimple(const Declared& simple, int depth) const;
  std::string TypeOfElement(const Declared& declared, int depth) const;

  const Report report_;
  NamedThings<Declared> elements_, simple_types_, complex_types_;
  size_t steps_ = 0;
};

}  // namespace docent::templates

#endif  // DOCENT_WORKFLOW_TEMPLATES_WSDL_SCHEMA_H_
