// Writes ParaView's properties of the representation "Sfumato" from the parameter lists of the techniques, and which
// files its reader opens from the table of formats:
//   sfumato_paraview_xml FILE
#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

#include "core/error.h"
#include "io/io.h"
#include "session/choice.h"
#include "session/look.h"

namespace {

using sfumato::Param;
using sfumato::ParamKind;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"') out += "&quot;";
    else out += c;
  }
  return out;
}

/// "point_size": "PointSize", or "Point Size".
std::string in_capitals(const std::string& name, bool with_spaces) {
  std::string out;
  bool starts = true;
  for (const char c : name) {
    if (c == '_') {
      starts = true;
      if (with_spaces) out += ' ';
    } else {
      out += starts ? char(std::toupper(c)) : c;
      starts = false;
    }
  }
  return out;
}

std::string choices(const std::vector<std::string>& names) {
  std::string out = "        <StringListDomain name=\"list\">\n";
  for (const std::string& name : names) out += "          <String value=\"" + name + "\"/>\n";
  return out + "        </StringListDomain>\n";
}

/// Above it a slider would have no places for what is usual.
constexpr double widest_slider = 100;

struct Property {
  std::string name, xml;
};

/// `technique` empty: a parameter that all of them share.
Property property_of(const Param& param, const std::string& technique) {
  std::string element = "StringVectorProperty", command = "SetText", domain, value = param.default_text;
  const bool is_number = param.kind == ParamKind::integer || param.kind == ParamKind::real;
  if (param.kind == ParamKind::choice) {
    domain = choices(param.choices);
  } else if (param.kind == ParamKind::boolean && !param.can_be_auto) {
    element = "IntVectorProperty", command = "SetFlag", domain = "        <BooleanDomain name=\"bool\"/>\n";
    value = value == "true" ? "1" : "0";
  } else if (param.kind == ParamKind::boolean) {
    domain = choices({"auto", "true", "false"});
  } else if (is_number && !param.can_be_auto) {
    const std::string kind = param.kind == ParamKind::real ? "Double" : "Int";
    element = kind + "VectorProperty", command = "SetNumber";
    std::ostringstream range;
    range << "        <" << kind << "RangeDomain name=\"range\"";
    if (param.min) range << " min=\"" << *param.min << '"';
    if (param.max && *param.max <= widest_slider) range << " max=\"" << *param.max << '"';
    domain = range.str() + "/>\n";
  }
  const std::string key = technique.empty() ? param.name : technique + "." + param.name;
  Property out{"Sfumato" + in_capitals(technique + "_" + param.name, false), {}};
  std::string help = param.help_text;
  if (!param.unit_text.empty()) help += " (" + param.unit_text + ")";
  if (!param.paper_text.empty()) help += " [" + param.paper_text + "]";
  out.xml = "      <" + element + " name=\"" + out.name + "\" command=\"" + command + "\" initial_string=\"" +
            key + "\" label=\"" + in_capitals(param.name, true) + "\" number_of_elements=\"1\" default_values=\"" +
            escaped(value) + "\" panel_visibility=\"" + (technique.empty() ? "advanced" : "default") + "\">\n" +
            domain + "        <Documentation>" + escaped(help) + "</Documentation>\n      </" + element + ">\n";
  return out;
}

std::string shown_for(const std::string& property, const std::string& value) {
  return "              <PropertyWidgetDecorator type=\"GenericDecorator\" mode=\"visibility\" property=\"" + property +
         "\" value=\"" + value + "\"/>\n";
}

std::string group(const std::string& label, const std::vector<std::string>& names,
                  const std::string& decorators) {
  std::string out = "          <PropertyGroup label=\"" + label + "\">\n";
  for (const std::string& name : names) out += "            <Property name=\"" + name + "\"/>\n";
  return out + "            <Hints>\n" + shown_for("Representation", "Sfumato") + decorators +
         "            </Hints>\n          </PropertyGroup>\n";
}

/// "las laz copc.laz": what ParaView compares the ends of names with.
std::string extensions() {
  std::set<std::string> all;
  for (const sfumato::io::FormatInfo& format : sfumato::io::formats()) {
    if (!format.can_read) continue;
    std::istringstream words(format.extensions);
    for (std::string word; words >> word;) all.insert(word.front() == '.' ? word.substr(1) : word);
  }
  std::string out;
  for (const std::string& each : all) out += (out.empty() ? "" : " ") + each;
  return out;
}

std::string reader() {
  return R"xml(  <ProxyGroup name="internal_sources">
    <SourceProxy name="SfumatoReaderCore" class="vtkSfumatoReader">
      <StringVectorProperty name="FileName" command="SetFileName" number_of_elements="1" animateable="0">
        <FileListDomain name="files"/>
      </StringVectorProperty>
      <IntVectorProperty name="MaximumPoints" command="SetMaximumPoints" number_of_elements="1" default_values="0">
        <IntRangeDomain name="range" min="0"/>
        <Documentation>At most so many points, from everywhere in the file; 0: all of them.</Documentation>
      </IntVectorProperty>
      <IntVectorProperty name="PointBudget" command="SetPointBudget" number_of_elements="1" default_values="5000000"
        panel_visibility="advanced">
        <IntRangeDomain name="range" min="0"/>
        <Documentation>Of files with levels of detail (COPC, EPT, Potree) that have more points, filters get the coarse levels
          within so many, and the representation Sfumato draws at most so many of what a view needs; 0: all points.</Documentation>
      </IntVectorProperty>
    </SourceProxy>
  </ProxyGroup>
  <ProxyGroup name="sources">
    <SourceProxy name="SfumatoReader" class="vtkFileSeriesReader" si_class="vtkSIMetaReaderProxy"
      file_name_method="SetFileName" label="Point cloud (sfumato)">
      <Documentation short_help="Reads point clouds.">Reads point clouds of every format of sfumato.</Documentation>
      <SubProxy>
        <Proxy name="Reader" proxygroup="internal_sources" proxyname="SfumatoReaderCore"/>
        <ExposedProperties>
          <Property name="MaximumPoints"/>
          <Property name="PointBudget"/>
        </ExposedProperties>
      </SubProxy>
      <StringVectorProperty name="FileNameInfo" command="GetCurrentFileName" information_only="1">
        <SimpleStringInformationHelper/>
      </StringVectorProperty>
      <StringVectorProperty name="FileNames" command="AddFileName" clean_command="RemoveAllFileNames" animateable="0"
        number_of_elements="0" repeat_command="1" panel_visibility="never">
        <FileListDomain name="files"/>
        <Documentation>A file, or the files of a time series.</Documentation>
      </StringVectorProperty>
      <DoubleVectorProperty name="TimestepValues" information_only="1" repeatable="1">
        <TimeStepsInformationHelper/>
      </DoubleVectorProperty>
      <Hints>
        <ReaderFactory extensions=")xml" +
         extensions() + R"xml(" file_description="Point clouds (sfumato)"/>
      </Hints>
    </SourceProxy>
  </ProxyGroup>
)xml";
}

std::string xml() {
  std::vector<std::string> names{sfumato::automatic_technique}, shared;
  std::string properties, groups;
  for (const sfumato::TechniqueInfo& info : sfumato::all_techniques()) {
    names.push_back(info.name);
    const sfumato::Look look(info);
    const std::vector<Param>& all = look.parameters.all();
    std::vector<std::string> own;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool is_shared = i >= look.own_count;
      if (is_shared && &info != &sfumato::all_techniques().front()) continue;
      Property property = property_of(all[i], is_shared ? "" : info.name);
      properties += property.xml;
      (is_shared ? shared : own).push_back(property.name);
    }
    groups += group("Sfumato: " + info.name, own, shown_for("SfumatoTechnique", info.name));
  }
  const std::string technique =
      "      <StringVectorProperty name=\"SfumatoTechnique\" command=\"SetTechnique\" label=\"Technique\" "
      "number_of_elements=\"1\" default_values=\"auto\">\n" +
      choices(names) +
      "        <Documentation>How the points are drawn; auto: as suits them.</Documentation>\n"
      "      </StringVectorProperty>\n";
  return "<ServerManagerConfiguration>\n" + reader() + R"(  <ProxyGroup name="representations">
    <RepresentationProxy name="SfumatoRepresentation" class="vtkSfumatoRepresentation"
      processes="client|renderserver|dataserver" base_proxygroup="representations" base_proxyname="SurfaceRepresentation">
      <Documentation>Points drawn by a technique of sfumato.</Documentation>
)" + technique +
         properties + R"(    </RepresentationProxy>
    <Extension name="GeometryRepresentation">
      <RepresentationType subproxy="SfumatoRepresentation" text="Sfumato" subtype="Surface"/>
      <SubProxy>
        <Proxy name="SfumatoRepresentation" proxygroup="representations" proxyname="SfumatoRepresentation"/>
        <ShareProperties subproxy="SurfaceRepresentation">
          <Exception name="Input"/>
          <Exception name="Visibility"/>
          <Exception name="Representation"/>
        </ShareProperties>
        <ExposedProperties>
)" + group("Sfumato", {"SfumatoTechnique"}, "") +
         groups + group("Sfumato: light and finish", shared, "") + R"(        </ExposedProperties>
      </SubProxy>
    </Extension>
  </ProxyGroup>
</ServerManagerConfiguration>
)";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: sfumato_paraview_xml FILE\n");
    return 2;
  }
  std::ofstream file(argv[1]);
  if (!(file << xml()) || !file.flush()) {
    std::fprintf(stderr, "sfumato_paraview_xml: %s cannot be written\n", argv[1]);
    return 1;
  }
}
