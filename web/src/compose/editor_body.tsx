// The parts of the open document beside each other: palette, canvas with the panels below it, properties and text.
import { PanelLeftOpen } from "lucide-react";
import { useCallback, useState } from "react";
import { useStable } from "../api/stable";
import { partAt } from "../cawl/document";
import type { AddWhere } from "./actions";
import { Canvas } from "./canvas";
import type { Finding } from "./findings";
import { FindingsPanel } from "./findings_panel";
import { PalettePanel } from "./palette_panel";
import { Properties } from "./properties";
import { FirstSteps, where } from "./quick_add";
import { SimulatePanel } from "./simulate_panel";
import { TextPane } from "./text_pane";
import { TrialsPanel } from "./trials_panel";
import { addFrom, type EditorModel, jumpTo, openStep } from "./use_editor";

export function EditorBody({ editor }: { editor: EditorModel }) {
  const { panels, palette, document, setOpen } = editor;
  return (
    <div className="editor-body">
      {panels.palette ? (
        <PalettePanel
          palette={palette}
          name={document.name}
          onAdd={(what) => addFrom(editor, what)}
          onImport={() => setOpen({ what: "import" })}
          onHide={() => panels.toggle("palette")}
        />
      ) : (
        <button
          className="palette-open button icon"
          aria-label="Show the palette"
          title="Show the palette (P)"
          onClick={() => panels.toggle("palette")}
        >
          <PanelLeftOpen size={15} />
        </button>
      )}
      <div className="stage">
        <FlowOnCanvas editor={editor} />
        <PanelsBelow editor={editor} />
      </div>
      <Dock editor={editor} />
    </div>
  );
}

function FlowOnCanvas({ editor }: { editor: EditorModel }) {
  const { session, document, shown, selection, findings, palette, breakpoints, setOpen } = editor;
  const serviceNames = useStable(
    new Set(palette.entries.filter((e) => e.kind === "service").map((e) => e.id)),
  );
  const quickAdd = useCallback((where: AddWhere) => setOpen({ what: "add", where }), [setOpen]);
  if (!shown)
    return (
      <div className="nothing grow">
        <h2>There is no flow to show</h2>
        <p>
          The text needs a &lt;CAWL&gt; element with a &lt;flow&gt; in it. Undo brings the last text back.
        </p>
      </div>
    );
  return (
    <Canvas
      shown={shown}
      findings={findings.list}
      serviceNames={serviceNames}
      selected={selection.steps}
      selectedLinks={selection.links}
      refreshed={session.refreshed}
      trial={editor.lower.states}
      breakpoints={breakpoints.steps}
      onBreakpoint={breakpoints.toggle}
      actions={editor.actions}
      onSelect={selection.select}
      onQuickAdd={quickAdd}
      onOpen={(key) => openStep(editor, key)}
    >
      {shown.steps.filter((s) => s.kind === "node").length === 0 && (
        <FirstSteps onAdd={() => quickAdd(where(shown))} />
      )}
      {document.problems.length > 0 && (
        <div className="broken" role="status">
          The text has a mistake. You see the last good steps; what is dashed can't be changed until it is
          mended.
        </div>
      )}
    </Canvas>
  );
}

function PanelsBelow({ editor }: { editor: EditorModel }) {
  const { session, document, shown, findings, trials, names, lower, selection } = editor;
  const [findingsOpen, setFindingsOpen] = useState(false);
  return (
    <>
      <FindingsPanel
        findings={findings}
        lineOf={(offset) =>
          session.view.state.doc.lineAt(Math.min(offset, session.view.state.doc.length)).number
        }
        open={findingsOpen}
        onToggle={() => setFindingsOpen(!findingsOpen)}
        onFix={editor.onFix}
        onJump={(finding) => jumpTo(editor, finding)}
      />
      {shown && (
        <SimulatePanel
          workflow={editor.workflow}
          text={document.text}
          shown={shown}
          variables={editor.variables}
          findings={findings}
          breakpoints={editor.breakpoints.steps}
          names={names}
          prefixes={editor.prefixes}
          vocabulary={editor.vocabulary}
          open={lower.panel === "simulate"}
          onToggle={() => lower.toggle("simulate")}
          onStates={lower.setSimulated}
        />
      )}
      {document.name && (
        <TrialsPanel
          trials={trials}
          text={document.text}
          names={names}
          open={lower.panel === "trials"}
          chosen={lower.tried}
          onToggle={() => lower.toggle("trials")}
          onChoose={lower.setTried}
          onStep={(step) => shown?.steps.some((s) => s.name === step) && selection.select([step], [], true)}
        />
      )}
    </>
  );
}

function Dock({ editor }: { editor: EditorModel }) {
  const { session, document, shown, flowKey, panels, selection, findings, palette } = editor;
  const onJump = (finding: Finding) => jumpTo(editor, finding);
  return (
    <aside className="dock" style={{ width: panels.width }} aria-label="Properties and text">
      <div
        className="dock-grip"
        role="separator"
        aria-orientation="vertical"
        aria-label="Width of the text"
        aria-valuenow={panels.width}
        aria-valuemin={320}
        aria-valuemax={Math.max(320, window.innerWidth - 420)}
        tabIndex={0}
        onPointerDown={panels.grip}
        onKeyDown={panels.gripKeys}
      />
      <div className="dock-properties">
        {shown && document.root && (
          <Properties
            session={session}
            document={document}
            flow={shown.flow}
            steps={selection.chosenSteps}
            links={selection.chosenLinks}
            actions={editor.actions}
            findings={findings.list}
            compiled={findings.conditions}
            palette={palette.entries}
            called={editor.called}
            vocabulary={editor.vocabulary}
            onFix={editor.onFix}
            onJump={onJump}
            onCopy={() => editor.clipboard.copy([...selection.steps])}
            runs={editor.trials.list}
            nameField={editor.nameField}
          />
        )}
      </div>
      <TextPane
        session={session}
        findings={findings.list}
        onFix={editor.onFix}
        onCaret={(offset) => {
          const part = partAt(session.shown, offset);
          if (part && part.flow.key === flowKey && (part.step || part.link))
            selection.mark(part.step ? [part.step.key] : [], part.link ? [part.link.key] : []);
        }}
      />
    </aside>
  );
}
