// Typesets the formulas of the book: they are plain text in the pages (so that they read in any editor, and .ci/book.py checks their
// symbols), and become letters, sub- and superscripts here. Sign for sign; needs no network. Without it they stay plain text.
(() => {
    const GREEK = {
        alpha: "α", beta: "β", gamma: "γ", delta: "δ", epsilon: "ε", eps: "ε", zeta: "ζ", eta: "η", theta: "θ", kappa: "κ", lambda: "λ",
        mu: "μ", nu: "ν", xi: "ξ", pi: "π", rho: "ρ", sigma: "σ", tau: "τ", phi: "φ", chi: "χ", psi: "ψ", omega: "ω",
        Gamma: "Γ", Delta: "Δ", Lambda: "Λ", Pi: "Π", Sigma: "Σ", Phi: "Φ", Psi: "Ψ", Omega: "Ω", sum: "∑", sqrt: "√",
    };
    const OPERATOR = { "<-": "←", "->": "→", "<=": "≤", ">=": "≥", "...": "…", "+-": "±", "-": "−", "*": "*" };
    // Number, word, index, operator, or one sign.
    const TOKEN = /\d+(?:\.\d+)?(?:e-?\d+)?|\p{L}\p{M}*(?:\p{L}\p{M}*)*|[_^](?:\{[^}]*\}|\([^)]*\)|-?[\p{L}\p{N}]+|[+−-])|<-|->|<=|>=|\.\.\.|\+-|[\s\S]/gu;
    const escape = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
    const letters = (word) => [...word.normalize("NFD")].filter((sign) => /\p{L}/u.test(sign)).length;

    function word(text) {
        if (GREEK[text]) return GREEK[text];
        // A derivative or difference of a Greek letter: "dtheta".
        if (/^[dD∂Δδ]/u.test(text) && GREEK[text.slice(1)]) return `<i>${text[0]}</i>${GREEK[text.slice(1)]}`;
        return letters(text) === 1 || /^[d∂δ]\p{L}$/u.test(text) ? `<i>${text}</i>` : text;
    }

    function typeset(text) {
        return text.replace(TOKEN, (token) => {
            if (/^[_^]./u.test(token)) {
                const tag = token[0] === "_" ? "sub" : "sup";
                const braces = token[1] === "{";
                return `<${tag}>${typeset(braces ? token.slice(2, -1) : token.slice(1))}</${tag}>`;
            }
            if (/^\p{L}/u.test(token)) return word(token);
            return escape(OPERATOR[token] ?? token);
        });
    }

    // Display: an indented block, which mdBook gives no language.
    for (const code of document.querySelectorAll(".content pre > code:not([class*='language-'])")) {
        const text = code.textContent.replace(/\n$/, "");
        if (!/\s\(\d+[a-z]?\)(-\(\d+\))?$/m.test(text)) continue;
        code.parentElement.classList.add("formula");
        code.innerHTML = text.split("\n").map((line) => {
            const [, formula, number = ""] = line.match(/^(.*?)(?:\s+(\(\d+[a-z]?\)(?:-\(\d+\))?))?$/);
            return `<span class="line"><span>${typeset(formula)}</span><span>${number}</span></span>`;
        }).join("");
    }

    // In the text: code that has letters of formulas only, no names.
    if (/\/math\//.test(location.pathname)) {
        for (const code of document.querySelectorAll(".content :not(pre) > code")) {
            const words = code.textContent.replace(/[_^](\{[^}]*\}|\([^)]*\)|[\p{L}\p{N}]+)/gu, "").match(/\p{L}[\p{L}\p{M}]*/gu) ?? [];
            const known = words.every((text) => letters(text) === 1 || GREEK[text] || /^(exp|ln|min|max|cos|sin|tr|det|var|Re|Im)$/.test(text));
            if (!words.length || !known || /::|\//.test(code.textContent) && /\.\w/.test(code.textContent)) continue;
            code.classList.add("formula");
            code.innerHTML = typeset(code.textContent);
        }
    }
})();
