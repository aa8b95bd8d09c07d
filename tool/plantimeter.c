/* tool/plantimeter.c: the program's entry. */
#include "traits/traits.h"

#include <stdio.h>

int main(void)
{
    puts("plantimeter " PLM_VERSION);
    return 0;
}
