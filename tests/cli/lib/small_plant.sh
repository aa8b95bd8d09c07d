# small_plant FILE [SCALE [LEAVES]]: a labelled plant of 600 points and more: a stem and square leaves on a grid.
small_plant() {
    awk -v scale="${2:-1}" -v leaves="${3:-3}" 'BEGIN {
        print "x,y,z,label,organ"
        for (i = 0; i < 240; i++) {
            a = i * 0.7
            printf "%.6g,%.6g,%.6g,1,0\n", scale * 0.002 * cos(a), scale * 0.002 * sin(a), scale * i * 0.0004
        }
        for (k = 0; k < leaves; k++)
            for (i = 0; i < 15; i++)
                for (j = 0; j < 15; j++) {
                    u = 0.01 + i * 0.002; v = (j - 7) * 0.002; turn = 2.1 * k
                    printf "%.6g,%.6g,%.6g,3,%d\n", scale * (u * cos(turn) - v * sin(turn)),
                        scale * (u * sin(turn) + v * cos(turn)), scale * (0.04 + 0.02 * k + 0.2 * u), k
                }
    }' >"$1"
}
