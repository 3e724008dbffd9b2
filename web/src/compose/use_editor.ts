// The open document as its view sees it: the text's model, the flow that is shown, what is selected, findings, and what can be done.
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { useNames } from "../api/prefixes";
import { useStable } from "../api/stable";
import { prefixesOf } from "../cawl/document";
import { shownFlow } from "../cawl/shown";
import { startVariables } from "../cawl/start_values";
import { useVocabulary } from "../facts/vocabulary";
import { usePalette } from "../flow/palette_data";
import { navigate, paths } from "../ui/router";
import { toast } from "../ui/toasts";
import { Actions, type AddWhere, type NewKind } from "./actions";
import { useBreakpoints } from "./breakpoints";
import { unsetFindings, useCalledFlows } from "./called_flows";
import { clipboardOf } from "./clipboard";
import type { DraftSync } from "./draft_sync";
import { type Finding, type Findings, useFindings } from "./findings";
import { useLiveVersion } from "./live_version";
import { usePanels } from "./panels";
import { where } from "./quick_add";
import { useServerDraft } from "./server_draft";
import type { Session } from "./session";
import { useTrials } from "./trials";
import { useLowerPanel } from "./use_lower_panel";
import { useSelection } from "./use_selection";
import { readVia, viaText } from "./via";

// The dialog that is open.
export type Opened =
  | { what: "import" }
  | { what: "add"; where: AddWhere }
  | { what: "connect"; from: string }
  | { what: "deploy" }
  | { what: "start" }
  | null;

export interface OpenDocument {
  session: Session;
  sync: DraftSync;
  name: string;
  flow: string;
  step: string;
  via: string;
  trial: string;
}

export function useEditor(props: OpenDocument) {
  const { session, sync, name, via } = props;
  session.versions.use();
  const document = session.shown;
  const { good } = session;
  const workflow = document.name || name;
  const { live, deployed } = useLiveVersion(workflow, sync); // a text that was renamed takes the place of what has its new name
  const shown = useMemo(() => shownFlow(document, good, props.flow), [document, good, props.flow]);
  const flowKey = shown?.flow.key ?? "";
  const [open, setOpen] = useState<Opened>(null);
  const panels = usePanels();
  const palette = usePalette();
  const names = useNames();
  const serverDraft = useServerDraft(name, session, sync);
  const prefixes = useStable(prefixesOf(document));
  const vocabulary = useVocabulary(prefixes);
  const called = useCalledFlows(document, palette.entries);
  const checked = useFindings(session);
  const trials = useTrials(document.name, document.text, checked);
  const lower = useLowerPanel(trials, props.trial);
  const breakpoints = useBreakpoints(name, shown?.flow.name ?? "");
  const unset = useMemo(
    () => unsetFindings(document, called, palette.entries, vocabulary),
    [document, called, palette.entries, vocabulary],
  );
  const findings = useMemo(
    () => (unset.length > 0 ? { ...checked, list: [...checked.list, ...unset] } : checked),
    [checked, unset],
  );
  const selection = useSelection(session, shown, props);
  const { select } = selection;
  const actions = useMemo(
    () =>
      new Actions(
        session,
        flowKey,
        (keys) => select(keys, [], true),
        (key) => select([], [key]),
        palette.entries,
      ),
    [session, flowKey, select, palette.entries],
  );
  useEffect(() => {
    const { from, to } = session.view.state.selection.main;
    if (panels.text) session.reveal(from, to);
  }, [session, panels.text]); // a text that was hidden has no place yet
  useEffect(() => {
    window.document.title = `${workflow} – Docent`;
  }, [workflow]);
  return {
    ...{
      session,
      sync,
      name,
      via,
      document,
      workflow,
      live,
      deployed,
      shown,
      flowKey,
      open,
      setOpen,
      panels,
    },
    ...{ palette, names, serverDraft, prefixes, vocabulary, called, trials, lower, breakpoints, findings },
    ...{ selection, actions },
    dirty: session.written !== live?.text,
    variables: startVariables(document, shown?.flow),
    nameField: useRef<HTMLInputElement>(null), // of the step whose properties are shown
    clipboard: clipboardOf(actions),
    onFix: useFix(session, findings),
  };
}
export type EditorModel = ReturnType<typeof useEditor>;

// Puts a finding's remedy into the text, where the text is still the one that was checked.
function useFix(session: Session, findings: Findings) {
  const checkedText = useRef("");
  checkedText.current = findings.of;
  return useCallback(
    (finding: Finding) => {
      if (session.text !== (finding.of ?? checkedText.current))
        return toast("bad", "The text has changed since", "The check runs again; then the remedy fits.");
      session.change(finding.fix);
      toast("good", "Mended", finding.remedy ?? finding.message);
    },
    [session],
  );
}

// Where a new step goes: into the link, or after the step, that is selected.
export function placeOfNew({ selection, shown }: EditorModel): AddWhere {
  const link = selection.chosenLinks[0];
  if (link && !selection.only) return { link: link.key };
  return selection.only ? { after: selection.only.key } : where(shown);
}
// Of the palette: after the last step nothing can come.
export function addFrom(editor: EditorModel, what: NewKind) {
  const isLast = editor.selection.only?.kind === "sink";
  editor.actions.add(what, isLast ? where(editor.shown) : placeOfNew(editor));
}
export function jumpTo({ session, selection, panels, name, flowKey, via }: EditorModel, finding: Finding) {
  if (finding.flow && finding.flow !== flowKey)
    navigate(paths.compose(name, finding.flow, finding.step, via));
  selection.select(finding.step ? [finding.step] : [], finding.link ? [finding.link] : []);
  panels.show("text");
  window.setTimeout(() => session.reveal(finding.from, finding.to));
}
// A step that runs a flow is opened in place: a flow of this document, or another workflow. Of another step the name is.
export function openStep({ document, shown, name, flowKey, via, nameField }: EditorModel, key: string) {
  const target = shown?.steps.find((s) => s.key === key)?.invokes.find((i) => i.kind === "subflow")?.target;
  if (!target) return nameField.current?.select();
  const way = viaText([...readVia(via), { name, flow: flowKey, step: key }]);
  const [workflow = target, flow = ""] = target.split("/");
  navigate(
    document.flows.some((f) => f.key === target)
      ? paths.compose(name, target, "", way)
      : paths.compose(workflow, flow, "", way),
  );
}
