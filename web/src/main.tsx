import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./app/app";
import { startKeys } from "./app/commands";
import { startRouter } from "./app/router";
import { startTheme } from "./app/theme";
import "./app/base.css";
import "./app/parts.css";

startTheme();
startRouter();
startKeys();
const place = document.getElementById("app");
if (place)
  createRoot(place).render(
    <StrictMode>
      <App />
    </StrictMode>,
  );
