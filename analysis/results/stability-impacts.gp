# Draws stability-impacts.svg and stability-impacts.pdf: gnuplot stability-impacts.gp
set encoding utf8
set terminal svg size 2374,340 noenhanced font 'Helvetica,14' background '#ffffff'
set output 'stability-impacts.svg'
set datafile separator comma
set datafile commentschars '#'
set datafile columnheaders
set datafile missing NaN
set grid lc rgb '#e0e0e0' lt 1
set border 3 lc rgb '#888888'
set tics nomirror scale 0.5 tc rgb '#333333'
set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7
set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7
set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8
set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8
set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8
set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8
set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8
set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8
set termoption enhanced
set style line 3 lc rgb '#009E73' lw 1.5 pt 8 ps 1.0
colours = '#0072B2 #D55E00 #009E73 #CC79A7'
shown(s) = s > 100000 ? 100000 : s < 1e-09 ? 1e-09 : s
place(x) = x < 1 ? 1 : x > 256 ? 256 : x
set multiplot
set logscale y
set yrange [3.3333333333333337e-10:10000000]
set ytics 1e-9,1e3
set format y '10^{%L}'
set object 1 rectangle from graph 0, first 1 to graph 1, graph 1 fc rgb '#f3e3e0' fs solid noborder behind
set label 1 'failed' at graph 0.02, graph 0.94 tc rgb '#8a4a3a'
set logscale x
set xrange [0.7692307692307692:332.8]
set format x '%g'
set ylabel 'worst measure / its limit' offset 1,0
unset key
set label 10 'ours (pinch)' at screen 0.0312, screen 0.9588 left noenhanced point ls 1 offset 0.8,0
set label 11 'thesis' at screen 0.0868, screen 0.9588 left noenhanced point ls 2 offset 0.8,0
set label 12 'plain cable joints' at screen 0.1222, screen 0.9588 left noenhanced point ls 3 offset 0.8,0
set lmargin at screen 0.0270
set rmargin at screen 0.1573
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'equal discs on a taut span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'equal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'equal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'equal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
unset label 10
unset label 11
unset label 12
set lmargin at screen 0.1666
set rmargin at screen 0.2969
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'unequal discs on a taut span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
unset ylabel
set format y ''
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'unequal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'unequal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'unequal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.3062
set rmargin at screen 0.4365
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'equal discs on a slack span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'equal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'equal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'equal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.4458
set rmargin at screen 0.5761
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'unequal discs on a slack span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'unequal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'unequal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'unequal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.5854
set rmargin at screen 0.7157
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'load into three cables' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'load into three cables' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'load into three cables' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'load into three cables' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.7250
set rmargin at screen 0.8553
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'ball on a span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'ball on a span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'ball on a span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'ball on a span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.8646
set rmargin at screen 0.9949
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'Newton''s cradle' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'Newton''s cradle' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'Newton''s cradle' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'Newton''s cradle' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
unset multiplot

reset
set terminal pdfcairo size 24.729,3.542 noenhanced font 'Helvetica,11'
set output 'stability-impacts.pdf'
set datafile separator comma
set datafile commentschars '#'
set datafile columnheaders
set datafile missing NaN
set grid lc rgb '#e0e0e0' lt 1
set border 3 lc rgb '#888888'
set tics nomirror scale 0.5 tc rgb '#333333'
set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7
set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7
set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8
set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8
set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8
set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8
set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8
set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8
set termoption enhanced
set style line 3 lc rgb '#009E73' lw 1.5 pt 8 ps 1.0
colours = '#0072B2 #D55E00 #009E73 #CC79A7'
shown(s) = s > 100000 ? 100000 : s < 1e-09 ? 1e-09 : s
place(x) = x < 1 ? 1 : x > 256 ? 256 : x
set multiplot
set logscale y
set yrange [3.3333333333333337e-10:10000000]
set ytics 1e-9,1e3
set format y '10^{%L}'
set object 1 rectangle from graph 0, first 1 to graph 1, graph 1 fc rgb '#f3e3e0' fs solid noborder behind
set label 1 'failed' at graph 0.02, graph 0.94 tc rgb '#8a4a3a'
set logscale x
set xrange [0.7692307692307692:332.8]
set format x '%g'
set ylabel 'worst measure / its limit' offset 1,0
unset key
set label 10 'ours (pinch)' at screen 0.0312, screen 0.9588 left noenhanced point ls 1 offset 0.8,0
set label 11 'thesis' at screen 0.0868, screen 0.9588 left noenhanced point ls 2 offset 0.8,0
set label 12 'plain cable joints' at screen 0.1222, screen 0.9588 left noenhanced point ls 3 offset 0.8,0
set lmargin at screen 0.0270
set rmargin at screen 0.1573
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'equal discs on a taut span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'equal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'equal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'equal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
unset label 10
unset label 11
unset label 12
set lmargin at screen 0.1666
set rmargin at screen 0.2969
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'unequal discs on a taut span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
unset ylabel
set format y ''
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'unequal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'unequal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'unequal discs on a taut span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.3062
set rmargin at screen 0.4365
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'equal discs on a slack span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'equal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'equal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'equal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.4458
set rmargin at screen 0.5761
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'unequal discs on a slack span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'unequal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'unequal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'unequal discs on a slack span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.5854
set rmargin at screen 0.7157
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'load into three cables' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'load into three cables' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'load into three cables' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'load into three cables' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.7250
set rmargin at screen 0.8553
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'ball on a span' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'ball on a span' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'ball on a span' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'ball on a span' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
set lmargin at screen 0.8646
set rmargin at screen 0.9949
set bmargin at screen 0.1941
set tmargin at screen 0.8412
set title 'Newton''s cradle' noenhanced offset 0,-0.6
set xlabel 'steps a frame' noenhanced
plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'cable' && strcol('series') eq 'Newton''s cradle' ? shown(column('severity')) : NaN) with linespoints ls 3 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'thesis' && strcol('series') eq 'Newton''s cradle' ? shown(column('severity')) : NaN) with linespoints ls 2 notitle, \
  'stability-impacts.csv' using (place(column('x'))):(strcol('method') eq 'pinch' && strcol('series') eq 'Newton''s cradle' ? shown(column('severity')) : NaN) with linespoints ls 1 notitle
unset multiplot

set output
