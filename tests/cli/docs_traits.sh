# docs/traits.md is what the program prints; `make docs` brings it up to date.
plantimeter traits --markdown | diff "$EXAMPLES/../../docs/traits.md" - && echo 'docs/traits.md is up to date'
