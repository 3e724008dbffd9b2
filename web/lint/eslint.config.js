// Rules of the app's code. Run from web/: `npm run lint`. Form is Prettier's alone (.prettierrc.json).
import reactHooks from "eslint-plugin-react-hooks";
import tseslint from "typescript-eslint";

const longest = 120; // lines of a function

export default tseslint.config(
  {
    ignores: ["dist", "node", "lint", "src/gen", "client/dist", "client/src/gen", "test-results", "public"],
  },
  {
    files: ["**/*.ts", "**/*.tsx"],
    extends: [tseslint.configs.recommendedTypeChecked],
    plugins: { "react-hooks": reactHooks },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    languageOptions: {
      parserOptions: {
        project: ["tsconfig.json", "client/tsconfig.json"],
        tsconfigRootDir: `${import.meta.dirname}/..`,
      },
    },
    rules: {
      "react-hooks/rules-of-hooks": "error",
      "react-hooks/exhaustive-deps": "error",
    },
  },
  {
    files: ["src/**"],
    rules: {
      "max-lines-per-function": ["error", { max: longest, skipBlankLines: true, skipComments: true }],
      "no-restricted-syntax": [
        "error",
        {
          selector: "CallExpression[callee.property.name=/^querySelector/] > Literal[value=/aria-label/]",
          message: "A label is for people. Keep a ref to the element.",
        },
        {
          selector:
            "CallExpression[callee.object.name='document'][callee.property.name=/^(querySelector|getElement)/]",
          message: "Keep a ref to the element.",
        },
      ],
    },
  },
  {
    // Longer than that since before the rule: a list that gets shorter.
    files: [
      "src/app/app.tsx",
      "src/compose/{deploy_dialog,documents,import_dialog,properties,simulate_panel}.tsx",
      "src/desk/{ask_dialog,desk}.tsx",
      "src/facts/tell.tsx",
      "src/hall/hall_drawing.tsx",
      "src/operate/{board,hall,reserve_dialog,run_actions,run_page,runs,time_bar,tour_panel}.tsx",
      "src/ui/combo.tsx",
      "src/visit/visit_map.tsx",
    ],
    rules: { "max-lines-per-function": "off" },
  },
  {
    // The element that the page itself has, a property of its head, and the nodes that React Flow draws.
    files: ["src/main.tsx", "src/visit/main.tsx", "src/compose/text_setup.ts", "src/compose/focus_step.ts"],
    rules: { "no-restricted-syntax": "off" },
  },
  {
    // Stand-ins for what answers later answer at once, and expect's matchers are of any type.
    files: ["tests/**"],
    rules: { "@typescript-eslint/require-await": "off", "@typescript-eslint/no-unsafe-assignment": "off" },
  },
);
