# The program tests itself: every check within its bound, exit code 0; one group alone; as JSON; wrong words are told. All groups
# at once are tests/stability.
plantimeter selftest --stability --only meshes --quiet
plantimeter selftest --only eigenvectors | sed -n '1p;/rank one/p' | cut -c1-78
plantimeter selftest --only places | grep 'jump'
plantimeter selftest --only hulls --json | grep -c '"verdict": "within"'
plantimeter selftest --only shoes
echo "exit code $?"
plantimeter selftest cloud.ply
