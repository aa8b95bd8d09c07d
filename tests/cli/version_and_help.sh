# The program tells its version, its commands and their options, all on standard output.
plantimeter --version | sed 's/[0-9.]*$/N/'
plantimeter --help | sed -n '1,2p'
plantimeter measure --help | sed -n '1,2p'
plantimeter help measure | grep -c -- '--traits'
plantimeter traits --help
plantimeter help --man | sed -n '/^.SH NAME/{n;p;}'
plantimeter help --completion | bash -n && echo 'bash reads the completion'
