// A new step by its name: what is offered, and where it goes.
import { Plus } from "lucide-react";
import type { ShownFlow } from "../cawl/shown";
import { Dialog } from "../ui/dialog";
import { Picker, type PickerItem } from "../ui/picker";
import type { Actions, AddWhere, NewKind } from "./actions";
import type { PaletteEntry } from "../flow/palette_data";
import { KindIcon } from "../flow/step_card";

// Where a step goes if nothing is selected: into the link that ends the flow, if there is one alone.
export function where(shown: ShownFlow | null): AddWhere {
  const sink = shown?.steps.find((s) => s.kind === "sink");
  const into = shown?.links.filter((l) => l.to === sink?.name && l.kind === "plain" && !l.stale) ?? [];
  return into.length === 1 && into[0] ? { link: into[0].key } : {};
}

export function QuickAdd(props: {
  palette: readonly PaletteEntry[];
  name: string;
  where: AddWhere;
  actions: Actions;
  onClose: () => void;
}) {
  const groups = { service: "Services", operation: "Robots' operations", workflow: "Workflows" };
  const add = (what: NewKind) => () => props.actions.add(what, props.where);
  const items: PickerItem[] = [
    {
      id: "empty",
      title: "Empty step",
      detail: "waits for a situation",
      icon: <Plus size={15} />,
      run: add({ kind: "empty", title: "Step" }),
    },
    ...props.palette
      .filter((e) => e.id !== props.name)
      .map((e): PickerItem => ({
        id: `${e.kind} ${e.id}`,
        title: e.title,
        words: e.id,
        detail: [e.kind, e.detail].filter(Boolean).join(" · "),
        group: groups[e.kind],
        icon: <KindIcon kind={e.kind} />,
        run: add(e),
      })),
  ];
  return (
    <Dialog label="Add a step" top onClose={props.onClose}>
      <Picker
        label="Add a step"
        placeholder="What happens next?"
        items={items}
        empty="Nothing has this name."
        onDone={props.onClose}
        other={(typed) => ({
          id: "other",
          title: `New step “${typed}”`,
          detail: "does nothing yet",
          icon: <Plus size={15} />,
          run: add({ kind: "empty", title: typed }),
        })}
      />
    </Dialog>
  );
}

export function FirstSteps({ onAdd }: { onAdd: () => void }) {
  return (
    <div className="first-steps">
      <h2>Add the first step</h2>
      <p className="quiet">
        A step is something a robot does. It opens when its situation is true, and leads to the next.
      </p>
      <button className="button primary" onClick={onAdd}>
        <Plus size={15} />
        Add a step<kbd>/</kbd>
      </button>
      <p className="faint small">or drag one from the left onto the arrow</p>
    </div>
  );
}
