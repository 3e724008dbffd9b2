// Rules of the app's code. Run from web/: `node lint/node_modules/eslint/bin/eslint.js --config lint/eslint.config.js .`
// Form is Prettier's alone (.prettierrc.json).
import reactHooks from "eslint-plugin-react-hooks";
import tseslint from "typescript-eslint";

export default tseslint.config(
  { ignores: ["dist", "node", "lint", "src/gen", "client/dist", "client/src/gen", "test-results", "public"] },
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
    // Stand-ins for what answers later answer at once, and expect's matchers are of any type.
    files: ["tests/**"],
    rules: { "@typescript-eslint/require-await": "off", "@typescript-eslint/no-unsafe-assignment": "off" },
  },
);
