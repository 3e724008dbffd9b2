import { BellRing, Footprints, Plus } from "lucide-react";
import type { Template } from "../cawl/templates";
import "./template_cards.css";

const icons: Record<string, typeof Plus> = { empty: Plus, guide: Footprints, event: BellRing };

export function TemplateCards(props: {
  templates: readonly Template[];
  onChoose: (template: Template) => void;
}) {
  return (
    <ul className="templates">
      {props.templates.map((template) => {
        const Icon = icons[template.id] ?? Plus;
        return (
          <li key={template.id}>
            <button className="template" onClick={() => props.onChoose(template)}>
              <span className="template-icon">
                <Icon size={18} />
              </span>
              <b>{template.title}</b>
              <span className="quiet small">{template.detail}</span>
            </button>
          </li>
        );
      })}
    </ul>
  );
}
