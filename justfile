# What one does here, each in one word. `just` alone lists it.

default:
    @just --list

# All tests of all crates.
test:
    cargo test --workspace --locked

# What a change must not break: format, warnings, dead links in the documentation.
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --all-features --locked -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --all-features --no-deps --locked

# Format all code.
fmt:
    cargo fmt --all

# A four-wheel drive with a puncture, and the report about it.
demo out="out/demo":
    cargo run --release -- demo --out {{out}}

# The accuracy table, recomputed.
score seeds="40":
    cargo run --release -p itpms-lab -- score --seeds {{seeds}}

# Time per sample and per frame.
bench:
    cargo bench -p itpms-bench --features time

# The documentation of the code, opened in a browser.
docs:
    cargo doc --workspace --no-deps --open

# The derivations as a book, in target/book (needs mdbook).
book:
    python3 .ci/book.py
    mdbook build docs

# Dependencies: licences, duplicates, sources, advisories (needs cargo-deny).
deny:
    cargo deny --all-features check

# Everything that is checked before a change is taken; steps can be named.
ci *steps:
    .ci/run {{steps}}
