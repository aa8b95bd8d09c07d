#!/usr/bin/env Rscript
# R2 and RMSE of a run against manual measurements, from the tables alone: how to read them in R (base R is enough).
#
# Usage: Rscript validate.R TRAITS.csv MANUAL.csv [AGREEMENT.csv]
#
# Rows are paired by plant_id, organ, organ_id and trait; repeated manual readings count as their mean. With the
# agreement.csv that `plantimeter validate` wrote of the same tables, its figures are compared with these: exit code 1
# where they differ.
arguments <- commandArgs(trailingOnly = TRUE)
if (!length(arguments) %in% 2:3) stop("Usage: Rscript validate.R TRAITS.csv MANUAL.csv [AGREEMENT.csv]")

key <- c("plant_id", "organ", "organ_id", "trait")
kind <- c(mm = 1, cm = 1, m = 1, mm2 = 2, cm2 = 2, m2 = 2, mm3 = 3, cm3 = 3, m3 = 3)
metres <- c(mm = 1e-3, cm = 1e-2, m = 1, mm2 = 1e-6, cm2 = 1e-4, m2 = 1, mm3 = 1e-9, cm3 = 1e-6, m3 = 1)

read <- function(path) {
  table <- read.csv(path, colClasses = "character", na.strings = NULL, check.names = FALSE)
  if ("status" %in% names(table)) table <- table[startsWith(table$status, "ok"), ]
  table <- table[!table$value %in% c("", "NA"), c(key, "value", "unit")]
  table$value <- as.numeric(table$value)
  table
}

estimates <- read(arguments[1])
manual <- read(arguments[2])
pairs <- merge(estimates, manual, by = key, suffixes = c("", "_manual"))
same <- pairs$unit == pairs$unit_manual
convertible <- !is.na(kind[pairs$unit]) & !is.na(kind[pairs$unit_manual]) & kind[pairs$unit] == kind[pairs$unit_manual]
pairs <- pairs[same | convertible, ]
same <- pairs$unit == pairs$unit_manual
factor_to <- ifelse(same, 1, metres[pairs$unit_manual] / metres[pairs$unit])
pairs$manual <- pairs$value_manual * factor_to
pairs <- aggregate(cbind(value, manual) ~ plant_id + organ + organ_id + trait, data = pairs, FUN = mean)

agreement <- function(p) {
  squared <- sum((p$value - p$manual)^2)
  total <- sum((p$manual - mean(p$manual))^2)
  data.frame(trait = p$trait[1], n = nrow(p), r2 = if (total > 0) 1 - squared / total else NA,
             rmse = sqrt(squared / nrow(p)))
}
found <- do.call(rbind, lapply(split(pairs, pairs$trait), agreement))
write.csv(format(found, digits = 6), row.names = FALSE, quote = FALSE)

if (length(arguments) == 3) {
  written <- read.csv(arguments[3])
  written <- written[written$group == "all" & written$statistic %in% c("n", "r2", "rmse") & !is.na(written$value) &
                       !grepl("azimuth", written$trait), ] # differences of azimuths go round the circle
  mine <- mapply(function(trait, statistic) found[found$trait == trait, statistic], written$trait, written$statistic)
  differs <- abs(mine - written$value) > 1e-7 + 1e-6 * abs(written$value)
  if (any(differs)) {
    print(cbind(written[differs, c("trait", "statistic", "value")], here = mine[differs]))
    quit(status = 1)
  }
}
