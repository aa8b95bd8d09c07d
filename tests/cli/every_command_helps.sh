# Each command tells its use and stands in the README.
plantimeter --help | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z]*\) .*/\1/p' >commands
while read -r command; do
    plantimeter "$command" --help >help || echo "$command --help fails"
    head -n 1 help | grep -q "^Usage: plantimeter $command" || echo "$command --help: $(head -n 1 help)"
    [ "$(wc -l <help)" -ge 4 ] || echo "$command --help says too little"
    [ "$command" = help ] || grep -q "plantimeter $command " "$EXAMPLES/../../README.md" || echo "README: no $command"
done <commands
[ -s commands ] && echo 'all commands help'
