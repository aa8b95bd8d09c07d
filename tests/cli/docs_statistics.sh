# docs/statistics.md is what the program prints; `make docs` brings it up to date.
plantimeter validate --statistics | diff "$EXAMPLES/../../docs/statistics.md" - && echo 'docs/statistics.md is up to date'
