# Reference values for tests/reports/test_agreement.c: every statistic of agreement by R's own functions (stats, boot) and
# by formulas written out here. Run from this folder: Rscript agreement_reference.R
# It reads agreement_data.csv (set, cluster, estimate, manual) and writes agreement_expected.csv.
suppressMessages(library(epiR))
data <- read.csv("agreement_data.csv")
out <- data.frame()
put <- function(set, name, value, low = NA, high = NA)
  out <<- rbind(out, data.frame(set = set, statistic = name, value = value, low = low, high = high))

passing_bablok <- function(x, y) {
  n <- length(x)
  s <- c()
  for (i in 1:(n - 1)) for (j in (i + 1):n) {
    dx <- x[j] - x[i]; dy <- y[j] - y[i]
    if (dx == 0 && dy == 0) next
    b <- if (dx == 0) Inf else dy / dx
    if (abs(b + 1) > 1e-10) s <- c(s, b)
  }
  s <- sort(s); m <- length(s); k <- sum(s < -1)
  slope <- if (m %% 2) s[(m + 1) / 2 + k] else (s[m / 2 + k] + s[m / 2 + 1 + k]) / 2
  c <- qnorm(0.975) * sqrt(n * (n - 1) * (2 * n + 5) / 18)
  m1 <- floor((m - c) / 2 + 0.5); m2 <- m - m1 + 1
  low <- s[m1 + k]; high <- s[m2 + k]
  list(slope = c(slope, low, high),
       intercept = c(median(y - slope * x), median(y - high * x), median(y - low * x)))
}

deming_fit <- function(x, y, lambda) {
  u <- sum((x - mean(x))^2); q <- sum((y - mean(y))^2); p <- sum((x - mean(x)) * (y - mean(y)))
  b <- (q - lambda * u + sqrt((q - lambda * u)^2 + 4 * lambda * p^2)) / (2 * p)
  c(b, mean(y) - b * mean(x))
}
deming <- function(x, y, lambda) {
  n <- length(x); full <- deming_fit(x, y, lambda)
  pseudo <- sapply(1:n, function(i) n * full - (n - 1) * deming_fit(x[-i], y[-i], lambda))
  se <- apply(pseudo, 1, sd) / sqrt(n); t <- qt(0.975, n - 2)
  rbind(c(full[1], full[1] - t * se[1], full[1] + t * se[1]), c(full[2], full[2] - t * se[2], full[2] + t * se[2]))
}

for (set in unique(data$set)) {
  p <- data$estimate[data$set == set]; m <- data$manual[data$set == set]; d <- p - m; n <- length(d)
  put(set, "r2", 1 - sum(d^2) / sum((m - mean(m))^2))
  r <- cor.test(p, m)
  put(set, "r_pearson", r$estimate, r$conf.int[1], r$conf.int[2])
  put(set, "r2_pearson", cor(p, m)^2)
  put(set, "rmse", sqrt(mean(d^2)))
  put(set, "rrmse", 100 * sqrt(mean(d^2)) / mean(m))
  put(set, "nrmse_range", 100 * sqrt(mean(d^2)) / diff(range(m)))
  put(set, "mape", 100 * mean(abs(d[m != 0]) / abs(m[m != 0])))
  put(set, "mae", mean(abs(d)))
  t <- t.test(p, m, paired = TRUE)
  put(set, "bias", mean(d), t$conf.int[1], t$conf.int[2])
  put(set, "bias_percent", 100 * mean(d) / mean(m))
  s <- sd(d)
  put(set, "sd_diff", s, s * sqrt((n - 1) / qchisq(0.975, n - 1)), s * sqrt((n - 1) / qchisq(0.025, n - 1)))
  z <- qnorm(0.975); half <- qt(0.975, n - 1) * s * sqrt(1 / n + z^2 / (2 * (n - 1)))
  put(set, "loa_low", mean(d) - z * s, mean(d) - z * s - half, mean(d) - z * s + half)
  put(set, "loa_high", mean(d) + z * s, mean(d) + z * s - half, mean(d) + z * s + half)
  # about the first value: lm gives up on a column of 1e9 + small
  a <- (p - p[1] + m - m[1]) / 2; fit <- summary(lm(d ~ a)); ci <- confint(lm(d ~ a))
  put(set, "proportional_bias_slope", fit$coefficients[2, 1], ci[2, 1], ci[2, 2])
  put(set, "proportional_bias_p", fit$coefficients[2, 4])
  # moments over n, as Lin 1989 defines it; the interval is epiR's (Lin 2000) for those moments
  vp <- mean((p - mean(p))^2); vm <- mean((m - mean(m))^2); cv <- mean((p - mean(p)) * (m - mean(m)))
  ccc <- 2 * cv / (vp + vm + mean(d)^2)
  rho <- cor(p, m); u <- (mean(p) - mean(m)) / (vp * vm)^0.25
  se <- sqrt(((1 - rho^2) * ccc^2 * (1 - ccc^2) / rho^2 + 2 * ccc^3 * (1 - ccc) * u^2 / rho -
              0.5 * ccc^4 * u^4 / rho^2) / (n - 2)) / (1 - ccc^2)
  put(set, "ccc", ccc, tanh(atanh(ccc) - z * se), tanh(atanh(ccc) + z * se))
  e <- epi.ccc(p, m, ci = "z-transform", conf.level = 0.95)$rho.c
  stopifnot(abs(e$est - ccc) < 1e-12, abs(e$lower - tanh(atanh(ccc) - z * se)) < 1e-3)
  put(set, "ccc_accuracy", ccc / rho)
  x <- m - mean(m); l <- lm(I(p - mean(p)) ~ x); ci <- confint(l)
  put(set, "ols_slope", coef(l)[2], ci[2, 1], ci[2, 2])
  b <- coef(l)[[2]]; v <- sum(residuals(l)^2) / (n - 2)
  i <- mean(p) - b * mean(m); half <- qt(0.975, n - 2) * sqrt(v * (1 / n + mean(m)^2 / sum(x^2)))
  put(set, "ols_intercept", i, i - half, i + half)
  dm <- deming(m, p, 1)
  put(set, "deming_slope", dm[1, 1], dm[1, 2], dm[1, 3])
  put(set, "deming_intercept", dm[2, 1], dm[2, 2], dm[2, 3])
  dm <- deming(m, p, 2.5)
  put(set, "deming_2.5_slope", dm[1, 1], dm[1, 2], dm[1, 3])
  put(set, "deming_2.5_intercept", dm[2, 1], dm[2, 2], dm[2, 3])
  pb <- passing_bablok(m, p)
  put(set, "passing_bablok_slope", pb$slope[1], pb$slope[2], pb$slope[3])
  put(set, "passing_bablok_intercept", pb$intercept[1], pb$intercept[2], pb$intercept[3])
  put(set, "paired_t_p", t$p.value)
  put(set, "wilcoxon_p", suppressWarnings(wilcox.test(p, m, paired = TRUE)$p.value))
  put(set, "shapiro_p", shapiro.test(d)$p.value)
  tolerance <- 1.5
  put(set, "tost_p", max(t.test(d, mu = -tolerance, alternative = "greater")$p.value,
                         t.test(d, mu = tolerance, alternative = "less")$p.value))
  put(set, "variance_ratio", var(p) / var(m))
  put(set, "variance_p", cor.test(p + m, p - m)$p.value)
}
# Repeatability: each cluster is a subject, the manual values its repeats (set "repeats").
rep <- data[data$set == "repeats", ]
fit <- anova(lm(manual ~ factor(cluster), data = rep))
k <- (nrow(rep) - sum(table(rep$cluster)^2) / nrow(rep)) / (length(unique(rep$cluster)) - 1)
put("repeats", "sd_within", sqrt(fit[2, 3]))
put("repeats", "icc", (fit[1, 3] - fit[2, 3]) / (fit[1, 3] + (k - 1) * fit[2, 3]))
# BCa intervals by package boot (its own random numbers, so they agree within Monte Carlo error only); the plants of
# "leaf_area" are drawn whole.
library(boot)
statistic <- function(p, m) c(1 - sum((p - m)^2) / sum((m - mean(m))^2), sqrt(mean((p - m)^2)), 100 * mean(abs(p - m) / abs(m)))
for (set in c("height", "leaf_area")) {
  rows <- split(data[data$set == set, ], data$cluster[data$set == set]); set.seed(1)
  b <- boot(rows, function(r, i) { r <- do.call(rbind, r[i]); statistic(r$estimate, r$manual) }, R = 20000)
  for (k in 1:3) {
    ci <- boot.ci(b, type = "bca", index = k)$bca
    put(set, paste0(c("r2", "rmse", "mape")[k], "_bca"), b$t0[k], ci[4], ci[5])
  }
}
out$value <- format(out$value, digits = 17); out$low <- format(out$low, digits = 17); out$high <- format(out$high, digits = 17)
out[] <- lapply(out, trimws)
write.csv(out, "agreement_expected.csv", row.names = FALSE, quote = FALSE)
