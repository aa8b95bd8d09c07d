# Writes the bytes of FILES, and a zero behind them, as a C array: cmake -DNAME=... -DFILES=... -DMADE=... -P this
set(hex "")
foreach(file IN LISTS FILES)
  file(READ ${file} bytes HEX)
  string(APPEND hex ${bytes} "0a")
endforeach()
string(LENGTH "${hex}" digits)
math(EXPR size "${digits} / 2")
string(REGEX REPLACE "(................................................................)" "\\1\n" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," hex "${hex}")
file(WRITE ${MADE} "/* Made from ${FILES}. */\n#include \"reports/assets.h\"\n\n"
                   "const size_t plm_asset_${NAME}_size = ${size};\n"
                   "const unsigned char plm_asset_${NAME}[] = {\n${hex}0x00};\n")
